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
    stale_handle,         ///< the resource was destroyed, or belongs to another device
    view_out_of_range,    ///< mips or layers beyond the texture's
    view_format,          ///< a view in a format of another size, or one that was not declared
    view_dimension,       ///< a view whose dimension its texture cannot have
    missing_usage,        ///< the texture or buffer was not created for this use
    buffer_out_of_range,  ///< a slice beyond its buffer
    buffer_alignment,     ///< a slice's offset is not a multiple of the device's alignment
    buffer_too_small,     ///< a slice smaller than the shader's block
    texel_kind,           ///< a float texture for an integer sampler, or the like
    format_unsupported,   ///< the device lacks this use of the format
    pipeline_targets,     ///< the pipeline's target formats or samples differ from the pass's
    pipeline_kind,        ///< a compute pipeline drawn, or a raster pipeline dispatched
    empty_work,           ///< zero groups, vertices or targets
    work_too_large,       ///< more groups or a larger target than the device takes
    conflicting_access,   ///< one dispatch or raster pass both writes and otherwise uses the same memory
    copy_out_of_range,
    copy_overlap,
    copy_format,      ///< source and destination texels differ in size
    pass_open,        ///< a second pass while one is open, or a submission with one open
    ticket_unknown,   ///< a readback that was taken already, or never made
    commands_spent,   ///< commands recorded after their submission
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
