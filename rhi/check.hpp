// Misuse of the RHI has a name each, and reaches the caller through the same sink as the driver's messages.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

namespace lumo::rhi {

/// A rule of the RHI that a caller broke. The command that broke it is dropped.
enum class Check : uint8_t {
    none,
    stale_handle,       ///< the resource was destroyed, or belongs to another device
    view_out_of_range,  ///< mips or layers beyond the texture's, or a viewport beyond its targets
    view_format,        ///< a view in a format that the texture did not declare, or not the shader's image's
    view_dimension,     ///< a view whose dimension its texture cannot have
    missing_usage,      ///< the texture or buffer was not created for this use
    buffer_out_of_range,  ///< a slice beyond its buffer
    buffer_alignment,     ///< a slice's offset is not a multiple of the device's alignment
    buffer_too_small,     ///< a slice smaller than the shader's block or the indirect arguments
    texel_kind,           ///< a float texture for an integer sampler, or the like
    format_unsupported,   ///< the device lacks this use of the format
    push_size,            ///< push constants of another size than the program's
    pipeline_targets,     ///< targets differ in size, layers, samples, or from what the pipeline was made for
    pipeline_kind,        ///< a compute pipeline drawn, or a raster pipeline dispatched
    empty_work,           ///< zero groups, vertices, texels or bytes
    work_too_large,       ///< more groups or a larger target than the device takes
    conflicting_access,   ///< one dispatch or raster pass both writes and otherwise uses the same memory
    copy_out_of_range,
    copy_overlap,
    copy_format,      ///< source and destination texels differ in size, or have several samples
    pass_open,        ///< a pass or submission is begun, or a submission ended, while one is open
    ticket_unknown,   ///< a readback that was taken already, never made, or not submitted
    not_presentable,  ///< presented without a window, twice in a submission, or what a window cannot show
    sync_order,       ///< a wait for a host's work after the submission's first pass
    commands_spent,   ///< commands used after their submission, or a pass after its end
    leaked_resource,  ///< a resource outlived its device
};

std::string_view to_string(Check check);

enum class Severity : uint8_t {
    notification,
    performance,
    low,
    medium,
    high,
    deprecated,
    portability,
    undefined,
    error
};

/// What went wrong or was worth saying.
struct Message {
    Severity severity = Severity::notification;
    Check check = Check::none;  ///< set for the RHI's own checks
    std::string id;             ///< the driver's or layer's own name for it, or the check's
    std::string text;
};

using MessageSink = std::function<void(const Message&)>;

/// The rule of what fails a test: errors, undefined behaviour, deprecated, portability, severity medium or
/// above.
constexpr bool is_failure(const Message& message) { return message.severity >= Severity::medium; }

}  // namespace lumo::rhi
