#include "rhi/check.hpp"

#include "rhi/device_info.hpp"

namespace lumo::rhi {

std::string_view to_string(Check check) {
    switch (check) {
        case Check::none:
            return "none";
        case Check::stale_handle:
            return "stale_handle";
        case Check::view_out_of_range:
            return "view_out_of_range";
        case Check::view_format:
            return "view_format";
        case Check::view_dimension:
            return "view_dimension";
        case Check::missing_usage:
            return "missing_usage";
        case Check::buffer_out_of_range:
            return "buffer_out_of_range";
        case Check::buffer_alignment:
            return "buffer_alignment";
        case Check::buffer_too_small:
            return "buffer_too_small";
        case Check::texel_kind:
            return "texel_kind";
        case Check::format_unsupported:
            return "format_unsupported";
        case Check::push_size:
            return "push_size";
        case Check::pipeline_targets:
            return "pipeline_targets";
        case Check::pipeline_kind:
            return "pipeline_kind";
        case Check::empty_work:
            return "empty_work";
        case Check::work_too_large:
            return "work_too_large";
        case Check::conflicting_access:
            return "conflicting_access";
        case Check::copy_out_of_range:
            return "copy_out_of_range";
        case Check::copy_overlap:
            return "copy_overlap";
        case Check::copy_format:
            return "copy_format";
        case Check::pass_open:
            return "pass_open";
        case Check::ticket_unknown:
            return "ticket_unknown";
        case Check::not_presentable:
            return "not_presentable";
        case Check::sync_order:
            return "sync_order";
        case Check::commands_spent:
            return "commands_spent";
        case Check::leaked_resource:
            return "leaked_resource";
    }
    return "unknown";
}

std::string_view to_string(Api api) { return api == Api::gl ? "gl" : "vulkan"; }

}  // namespace lumo::rhi
