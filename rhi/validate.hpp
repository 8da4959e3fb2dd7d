// The rules of the RHI as functions of descriptions alone: what is checked before a command is recorded or a
// resource is made.
#pragma once

#include <fmt/format.h>
#include <functional>
#include <optional>
#include <span>
#include <string>

#include "rhi/check.hpp"
#include "rhi/device_info.hpp"
#include "rhi/error.hpp"
#include "rhi/resources.hpp"
#include "rhi/work.hpp"

namespace lumo::rhi {

/// A broken rule; or, without a check, something that the environment refused.
struct Fault {
    Check check = Check::none;
    std::string text;  ///< names the resource and the value
    ErrorKind kind = ErrorKind::invalid_argument;
};
/// Nothing where all is well.
using Verdict = std::optional<Fault>;

/// A broken rule with its text by fmt.
template <class... Args>
Fault fault(Check check, fmt::format_string<Args...> format, Args&&... args) {
    return {check, fmt::format(format, std::forward<Args>(args)...)};
}

inline Fault stale(std::string_view what) {
    return fault(Check::stale_handle, "{} that is gone or another device's", what);
}

/// `"name"`, or a word for what has none.
std::string quoted(const std::string& name);

// -- making resources: Errors invalid_argument, unsupported

Result<void> check_desc(const BufferDesc& desc);
/// `caps` of the texture's format.
Result<void> check_desc(const TextureDesc& desc, FormatCaps caps, const Limits& limits);
Result<void> check_desc(const SamplerDesc& desc);
/// A compute pipeline has no raster state. `caps` gives those of any format.
Result<void> check_pipeline(const ProgramInfo& program, const RasterState* raster, const DeviceInfo& device,
                            const std::function<FormatCaps(Format)>& caps);

// -- using them

/// A slice for `usage` (none: a copy) whose offset is a multiple of `alignment`.
Verdict check_slice(const BufferDesc& buffer, const BufferSlice& slice, BufferUsage usage,
                    uint64_t alignment);
Verdict check_buffer_binding(const BindingInfo& binding, const BufferDesc& buffer, const BufferSlice& slice,
                             const Limits& limits);
/// Range, dimension and format of a view.
Verdict check_view(const TextureDesc& texture, const TextureView& view);
/// `caps` of the view's format; `sampler` is null for a storage image.
Verdict check_texture_binding(const BindingInfo& binding, const TextureDesc& texture, const TextureView& view,
                              FormatCaps caps, const SamplerDesc* sampler);
/// A view as colour or depth target.
Verdict check_target(const TextureDesc& texture, const TextureView& view, FormatCaps caps, bool depth);
Verdict check_region(const TextureDesc& texture, const TextureRegion& region);
Verdict check_copy(const TextureDesc& source, const TextureRegion& source_region,
                   const TextureDesc& destination, const TextureRegion& destination_region,
                   bool same_texture);
/// The value in the variant that `format` asks for; zeros fit every format.
std::optional<ClearColor> clear_for(Format format, const ClearColor& value);
bool is_zero(const ClearColor& value);

/// Whether a region, or each mip of a view, is all that the texture has there.
bool covers_mip(const TextureDesc& texture, const TextureRegion& region);
bool covers_layers(const TextureDesc& texture, const TextureView& view);
TexelKind texel_kind(Format format);

}  // namespace lumo::rhi
