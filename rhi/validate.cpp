#include "rhi/validate.hpp"

#include <algorithm>
#include <bit>

#include "rhi/rhi.hpp"

namespace lumo::rhi {
namespace {

std::string_view dimension_name(Dimension dimension) {
    switch (dimension) {
        case Dimension::d1:
            return "1D";
        case Dimension::d2:
            return "2D";
        case Dimension::d3:
            return "3D";
        case Dimension::cube:
            return "cube";
        case Dimension::d1_array:
            return "1D array";
        case Dimension::d2_array:
            return "2D array";
        case Dimension::cube_array:
            return "cube array";
        case Dimension::d2_multisample:
            return "2D multisample";
    }
    return "unknown";
}

std::string_view kind_name(TexelKind kind) {
    switch (kind) {
        case TexelKind::floating:
            return "float";
        case TexelKind::uint:
            return "unsigned integer";
        case TexelKind::sint:
            return "signed integer";
    }
    return "unknown";
}

std::string_view name_of(Format format) { return format_info(format).name; }

bool is_cube(Dimension dimension) {
    return dimension == Dimension::cube || dimension == Dimension::cube_array;
}

/// Whether `layers` is a count that a texture or view of this dimension can have.
bool fits_layers(Dimension dimension, uint32_t layers) {
    switch (dimension) {
        case Dimension::cube:
            return layers == 6;
        case Dimension::cube_array:
            return layers > 0 && layers % 6 == 0;
        case Dimension::d1_array:
        case Dimension::d2_array:
            return layers > 0;
        default:
            return layers == 1;
    }
}

bool fits_texture(Dimension texture, Dimension view) {
    using enum Dimension;
    switch (texture) {
        case d1:
        case d1_array:
            return view == d1 || view == d1_array;
        case d2:
        case d2_array:
            return view == d2 || view == d2_array;
        case cube:
        case cube_array:
            return view == d2 || view == d2_array || is_cube(view);
        default:
            return view == texture;
    }
}

bool fits_extent(Dimension dimension, const Extent& extent) {
    if (extent.width == 0 || extent.height == 0 || extent.depth == 0) return false;
    if (dimension == Dimension::d1 || dimension == Dimension::d1_array)
        return extent.height == 1 && extent.depth == 1;
    if (is_cube(dimension) && extent.width != extent.height) return false;
    return dimension == Dimension::d3 || extent.depth == 1;
}

bool is_layered_target(Dimension dimension) {
    return dimension != Dimension::d1 && dimension != Dimension::d1_array && dimension != Dimension::d3;
}

std::string extent_text(const Extent& e) { return fmt::format("{}x{}x{}", e.width, e.height, e.depth); }

std::string_view usage_name(BufferUsage usage) {
    switch (usage) {
        case BufferUsage::storage:
            return "storage";
        case BufferUsage::uniform:
            return "uniform";
        case BufferUsage::index:
            return "index";
        case BufferUsage::indirect:
            return "indirect";
        default:
            return "none";
    }
}

/// One side of a box: [begin, begin + length) within `whole`, at the grid of a format's blocks.
bool fits_side(uint32_t begin, uint32_t length, uint32_t whole, uint32_t block) {
    if (length == 0 || begin > whole || length > whole - begin) return false;
    return begin % block == 0 && (length % block == 0 || begin + length == whole);
}

bool overlaps(uint32_t a, uint32_t b, uint32_t length) { return a < b + length && b < a + length; }

}  // namespace

std::string quoted(const std::string& name) { return name.empty() ? "(unnamed)" : '"' + name + '"'; }

TexelKind texel_kind(Format format) {
    switch (format_info(format).kind) {
        case FormatKind::uint:
            return TexelKind::uint;
        case FormatKind::sint:
            return TexelKind::sint;
        default:
            return TexelKind::floating;
    }
}

Result<void> check_desc(const BufferDesc& desc) {
    const std::string subject = "buffer " + quoted(desc.name);
    if (desc.size == 0) return fail(ErrorKind::invalid_argument, subject, "its size is 0 bytes");
    return {};
}

Result<void> check_desc(const TextureDesc& desc, FormatCaps caps, const Limits& limits) {
    const std::string subject = "texture " + quoted(desc.name);
    const auto invalid = [&](std::string message) {
        return fail(ErrorKind::invalid_argument, subject, std::move(message));
    };
    const auto unsupported = [&](std::string message, std::string remedy = {}) {
        return fail(ErrorKind::unsupported, subject, std::move(message), std::move(remedy));
    };
    const FormatInfo& format = format_info(desc.format);
    const bool multisample = desc.dimension == Dimension::d2_multisample;

    if (desc.format == Format::undefined) return invalid("it has no format");
    if (!fits_extent(desc.dimension, desc.extent))
        return invalid(fmt::format("a {} texture cannot measure {}", dimension_name(desc.dimension),
                                   extent_text(desc.extent)));
    if (!fits_layers(desc.dimension, desc.layers))
        return invalid(
            fmt::format("a {} texture cannot have {} layers", dimension_name(desc.dimension), desc.layers));
    const uint32_t most_mips = multisample ? 1 : full_mips(desc.extent);
    if (desc.mips == 0 || desc.mips > most_mips)
        return invalid(fmt::format("it asks for {} mips and can have 1 to {}", desc.mips, most_mips));
    if (!std::has_single_bit(desc.samples) || (desc.samples > 1) != multisample)
        return invalid(
            fmt::format("a {} texture cannot have {} samples", dimension_name(desc.dimension), desc.samples));
    if (desc.usage == TextureUsage::none) return invalid("it has no usage");
    for (Format view : desc.view_formats) {
        const FormatInfo& other = format_info(view);
        if (other.bytes_per_block != format.bytes_per_block || other.block_side != format.block_side)
            return invalid(
                fmt::format("view format {} has texels of another size than {}", other.name, format.name));
    }

    const bool volume = desc.dimension == Dimension::d3;
    const uint32_t most = volume ? limits.max_texture_side_3d : limits.max_texture_side_2d;
    if (std::max({desc.extent.width, desc.extent.height, desc.extent.depth}) > most)
        return unsupported(
            fmt::format("{} is beyond this device's {} a side", extent_text(desc.extent), most));
    if (desc.layers > limits.max_texture_layers)
        return unsupported(
            fmt::format("{} layers are beyond this device's {}", desc.layers, limits.max_texture_layers));
    if (desc.samples > limits.max_samples)
        return unsupported(
            fmt::format("{} samples are beyond this device's {}", desc.samples, limits.max_samples));
    if (has(desc.usage, TextureUsage::attachment) && !is_layered_target(desc.dimension))
        return unsupported(fmt::format("a {} texture cannot be a target", dimension_name(desc.dimension)));

    const auto lacks = [&](FormatCaps cap) { return !has(caps, cap); };
    const auto refuse = [&](std::string_view use) {
        return unsupported(fmt::format("this device cannot use {} as {}", format.name, use),
                           "choose another format, see Device::format_caps");
    };
    if (has(desc.usage, TextureUsage::sampled) && lacks(FormatCaps::sampled))
        return refuse("sampled texture");
    // A view in another format may be what stores: such a texture needs no storage of its own format.
    if (has(desc.usage, TextureUsage::storage) && desc.view_formats.empty() && lacks(FormatCaps::storage))
        return refuse("storage image");
    if (has(desc.usage, TextureUsage::attachment) && lacks(FormatCaps::attachment)) return refuse("target");
    if (multisample && lacks(FormatCaps::multisample)) return refuse("multisampled texture");
    return {};
}

Result<void> check_desc(const SamplerDesc& desc) {
    if (!(desc.min_lod <= desc.max_lod))
        return fail(
            ErrorKind::invalid_argument, "sampler",
            fmt::format("its lowest level of detail {} is above its highest {}", desc.min_lod, desc.max_lod));
    if (!(desc.max_anisotropy >= 1))
        return fail(ErrorKind::invalid_argument, "sampler",
                    fmt::format("anisotropy {} is below 1", desc.max_anisotropy));
    return {};
}

Result<void> check_pipeline(const ProgramInfo& program, const RasterState* raster, const DeviceInfo& device,
                            const std::function<FormatCaps(Format)>& caps) {
    const std::string subject = fmt::format("program \"{}\"", program.name);
    const auto invalid = [&](std::string message) {
        return fail(ErrorKind::invalid_argument, subject, std::move(message));
    };
    const auto unsupported = [&](std::string message) {
        return fail(ErrorKind::unsupported, subject, std::move(message));
    };
    if (program.stages.empty()) return invalid("it has no stages");
    if (program.is_compute() != (raster == nullptr))
        return invalid(raster ? "a compute program cannot make a raster pipeline"
                              : "a raster program cannot make a compute pipeline");
    const Limits& limits = device.limits;
    if (!raster) {
        uint64_t invocations = 1;
        for (int axis = 0; axis < 3; ++axis) {
            invocations *= program.local_size[axis];
            if (program.local_size[axis] > limits.max_group_size[axis])
                return unsupported(fmt::format("its group of {} on axis {} is beyond this device's {}",
                                               program.local_size[axis], axis, limits.max_group_size[axis]));
        }
        if (invocations > limits.max_group_invocations)
            return unsupported(fmt::format("its {} invocations a group are beyond this device's {}",
                                           invocations, limits.max_group_invocations));
        return {};
    }

    for (const StageInfo& stage : program.stages)
        if (stage.stage == Stages::geometry && !device.geometry_shader)
            return unsupported("this device has no geometry shaders");
    if (raster->color.size() > limits.max_color_targets)
        return unsupported(fmt::format("{} colour targets are beyond this device's {}", raster->color.size(),
                                       limits.max_color_targets));
    if (!std::has_single_bit(raster->samples) || raster->samples > limits.max_samples)
        return unsupported(fmt::format("{} samples are not among this device's 1 to {}", raster->samples,
                                       limits.max_samples));
    for (size_t i = 0; i < raster->color.size(); ++i) {
        const ColorTargetState& target = raster->color[i];
        const FormatInfo& format = format_info(target.format);
        const FormatCaps able = caps(target.format);
        if (target.format == Format::undefined || format.kind == FormatKind::depth)
            return invalid(fmt::format("colour target {} has format {}", i, format.name));
        if (!(program.color_outputs >> i & 1) && target.write_mask != 0)
            return invalid(fmt::format("it does not write colour target {}", i));
        if (!has(able, FormatCaps::attachment) || (target.blend && !has(able, FormatCaps::blend)) ||
            (raster->samples > 1 && !has(able, FormatCaps::multisample)))
            return unsupported(
                fmt::format("this device cannot draw into {} like that (colour target {})", format.name, i));
    }
    if (raster->depth && format_info(raster->depth->format).kind != FormatKind::depth)
        return invalid(fmt::format("its depth target has format {}", name_of(raster->depth->format)));
    return {};
}

Verdict check_slice(const BufferDesc& buffer, const BufferSlice& slice, BufferUsage usage,
                    uint64_t alignment) {
    if (usage != BufferUsage::none && !has(buffer.usage, usage))
        return fault(Check::missing_usage, "buffer {} was not created with usage {}", quoted(buffer.name),
                     usage_name(usage));
    if (slice.size == 0) return fault(Check::empty_work, "no bytes of buffer {}", quoted(buffer.name));
    if (slice.offset > buffer.size || slice.size > buffer.size - slice.offset)
        return fault(Check::buffer_out_of_range, "{} bytes at offset {} of buffer {}, which has {} bytes",
                     slice.size, slice.offset, quoted(buffer.name), buffer.size);
    if (slice.offset % alignment != 0)
        return fault(Check::buffer_alignment, "offset {} into buffer {} is not a multiple of {}",
                     slice.offset, quoted(buffer.name), alignment);
    return {};
}

Verdict check_buffer_binding(const BindingInfo& binding, const BufferDesc& buffer, const BufferSlice& slice,
                             const Limits& limits) {
    const bool uniform = binding.kind == BindingKind::uniform_buffer;
    const uint64_t alignment = uniform ? limits.uniform_alignment : limits.storage_alignment;
    const uint64_t most = uniform ? limits.max_uniform_bytes : limits.max_storage_bytes;
    if (auto bad =
            check_slice(buffer, slice, uniform ? BufferUsage::uniform : BufferUsage::storage, alignment))
        return bad;
    if (slice.size < binding.min_size)
        return fault(Check::buffer_too_small, "{} bytes of buffer {} for a block of {}", slice.size,
                     quoted(buffer.name), binding.min_size);
    if (slice.size > most)
        return fault(Check::work_too_large, "{} bytes of buffer {} are beyond this device's {} a binding",
                     slice.size, quoted(buffer.name), most);
    return {};
}

Verdict check_view(const TextureDesc& texture, const TextureView& view) {
    if (view.mips == 0 || view.first_mip >= texture.mips || view.mips > texture.mips - view.first_mip)
        return fault(Check::view_out_of_range, "{} mips from {} of texture {}, which has {}", view.mips,
                     view.first_mip, quoted(texture.name), texture.mips);
    if (view.layers == 0 || view.first_layer >= texture.layers ||
        view.layers > texture.layers - view.first_layer)
        return fault(Check::view_out_of_range, "{} layers from {} of texture {}, which has {}", view.layers,
                     view.first_layer, quoted(texture.name), texture.layers);
    if (!fits_texture(texture.dimension, view.dimension) || !fits_layers(view.dimension, view.layers))
        return fault(Check::view_dimension, "a {} view of {} layers of texture {}, which is {}",
                     dimension_name(view.dimension), view.layers, quoted(texture.name),
                     dimension_name(texture.dimension));
    if (view.format != texture.format &&
        std::ranges::find(texture.view_formats, view.format) == texture.view_formats.end())
        return fault(Check::view_format, "texture {} has format {} and did not declare {}",
                     quoted(texture.name), name_of(texture.format), name_of(view.format));
    return {};
}

Verdict check_texture_binding(const BindingInfo& binding, const TextureDesc& texture, const TextureView& view,
                              FormatCaps caps, const SamplerDesc* sampler) {
    const bool storage = binding.kind == BindingKind::storage_image;
    if (!has(texture.usage, storage ? TextureUsage::storage : TextureUsage::sampled))
        return fault(Check::missing_usage, "texture {} was not created with usage {}", quoted(texture.name),
                     storage ? "storage" : "sampled");
    if (auto bad = check_view(texture, view)) return bad;
    if (view.dimension != binding.dimension)
        return fault(Check::view_dimension, "a {} view of texture {} for a shader that reads {}",
                     dimension_name(view.dimension), quoted(texture.name), dimension_name(binding.dimension));
    if (texel_kind(view.format) != binding.texel)
        return fault(Check::texel_kind, "{} texels of texture {} for a shader that takes {}",
                     name_of(view.format), quoted(texture.name), kind_name(binding.texel));
    const auto lacks = [&](std::string_view use) {
        return fault(Check::format_unsupported, "this device cannot use {} of texture {} {}",
                     name_of(view.format), quoted(texture.name), use);
    };
    if (storage) {
        if (view.mips != 1)
            return fault(Check::view_out_of_range, "{} mips of texture {} as a storage image, which has one",
                         view.mips, quoted(texture.name));
        if (binding.format != Format::undefined && binding.format != view.format)
            return fault(Check::view_format, "a view of texture {} in {} for an image declared as {}",
                         quoted(texture.name), name_of(view.format), name_of(binding.format));
        const FormatCaps needed =
            binding.access == ShaderAccess::atomic ? FormatCaps::storage_atomic : FormatCaps::storage;
        if (!has(caps, needed))
            return lacks(needed == FormatCaps::storage ? "as a storage image" : "for atomics");
    } else {
        if (!has(caps, FormatCaps::sampled)) return lacks("as a sampled texture");
        const bool filters = sampler->magnification == FilterMode::linear ||
                             sampler->minification == FilterMode::linear ||
                             sampler->mip == FilterMode::linear || sampler->max_anisotropy > 1;
        if (filters && texture.samples == 1 && !has(caps, FormatCaps::linear_filter))
            return lacks("with a filter: its sampler must be nearest throughout");
    }
    return {};
}

Verdict check_target(const TextureDesc& texture, const TextureView& view, FormatCaps caps, bool depth) {
    if (!has(texture.usage, TextureUsage::attachment))
        return fault(Check::missing_usage, "texture {} was not created with usage attachment",
                     quoted(texture.name));
    if (auto bad = check_view(texture, view)) return bad;
    if (view.mips != 1)
        return fault(Check::view_out_of_range, "{} mips of texture {} as a target, which has one", view.mips,
                     quoted(texture.name));
    if ((format_info(view.format).kind == FormatKind::depth) != depth)
        return fault(Check::texel_kind, "texture {} of format {} as a {} target", quoted(texture.name),
                     name_of(view.format), depth ? "depth" : "colour");
    if (!has(caps, FormatCaps::attachment))
        return fault(Check::format_unsupported, "this device cannot draw into {} of texture {}",
                     name_of(view.format), quoted(texture.name));
    return {};
}

Verdict check_region(const TextureDesc& texture, const TextureRegion& region) {
    const auto out = [&](std::string_view what) {
        return fault(Check::copy_out_of_range,
                     "{} of a region of {} at {},{},{} in mip {}, layers {} to {}, of texture {}", what,
                     extent_text(region.extent), region.x, region.y, region.z, region.mip, region.first_layer,
                     uint64_t{region.first_layer} + region.layers, quoted(texture.name));
    };
    if (texture.samples > 1)
        return fault(Check::copy_format, "texture {} has {} samples", quoted(texture.name), texture.samples);
    if (region.mip >= texture.mips) return out("the mip");
    if (region.layers == 0 || region.first_layer >= texture.layers ||
        region.layers > texture.layers - region.first_layer)
        return out("the layers");
    const Extent whole = mip_extent(texture.extent, region.mip);
    const uint32_t block = format_info(texture.format).block_side;
    if (!fits_side(region.x, region.extent.width, whole.width, block)) return out("the width");
    if (!fits_side(region.y, region.extent.height, whole.height, block)) return out("the height");
    if (!fits_side(region.z, region.extent.depth, whole.depth, 1)) return out("the depth");
    return {};
}

Verdict check_copy(const TextureDesc& source, const TextureRegion& source_region,
                   const TextureDesc& destination, const TextureRegion& destination_region,
                   bool same_texture) {
    if (auto bad = check_region(source, source_region)) return bad;
    if (auto bad = check_region(destination, destination_region)) return bad;
    const FormatInfo& from = format_info(source.format);
    const FormatInfo& to = format_info(destination.format);
    if (from.bytes_per_block != to.bytes_per_block || from.block_side != to.block_side ||
        (from.kind == FormatKind::depth) != (to.kind == FormatKind::depth))
        return fault(Check::copy_format, "from texture {} of {} to texture {} of {}", quoted(source.name),
                     from.name, quoted(destination.name), to.name);
    const TextureRegion &a = source_region, &b = destination_region;
    if (a.extent != b.extent || a.layers != b.layers)
        return fault(Check::copy_out_of_range, "from {} texels in {} layers of texture {} to {} in {} of {}",
                     extent_text(a.extent), a.layers, quoted(source.name), extent_text(b.extent), b.layers,
                     quoted(destination.name));
    if (same_texture && a.mip == b.mip && overlaps(a.first_layer, b.first_layer, a.layers) &&
        overlaps(a.x, b.x, a.extent.width) && overlaps(a.y, b.y, a.extent.height) &&
        overlaps(a.z, b.z, a.extent.depth))
        return fault(Check::copy_overlap, "both regions share texels of mip {} of texture {}", a.mip,
                     quoted(source.name));
    return {};
}

bool is_zero(const ClearColor& value) {
    return std::visit(
        [](const auto& channels) { return std::ranges::all_of(channels, [](auto c) { return c == 0; }); },
        value);
}

std::optional<ClearColor> clear_for(Format format, const ClearColor& value) {
    const TexelKind kind = texel_kind(format);
    const bool matches = (kind == TexelKind::floating && value.index() == 0) ||
                         (kind == TexelKind::uint && value.index() == 1) ||
                         (kind == TexelKind::sint && value.index() == 2);
    if (matches) return value;
    if (!is_zero(value)) return {};
    if (kind == TexelKind::uint) return std::array<uint32_t, 4>{};
    if (kind == TexelKind::sint) return std::array<int32_t, 4>{};
    return std::array<float, 4>{};
}

bool covers_mip(const TextureDesc& texture, const TextureRegion& region) {
    return region.layers == texture.layers && region.extent == mip_extent(texture.extent, region.mip);
}

bool covers_layers(const TextureDesc& texture, const TextureView& view) {
    return view.layers == texture.layers;
}

TextureRegion whole_mip(const TextureDesc& desc, uint32_t mip) {
    return {.mip = mip, .layers = desc.layers, .extent = mip_extent(desc.extent, mip)};
}

uint64_t region_bytes(Format format, const TextureRegion& region) {
    const FormatInfo& info = format_info(format);
    const uint64_t side = info.block_side;
    const uint64_t columns = (region.extent.width + side - 1) / side;
    const uint64_t rows = (region.extent.height + side - 1) / side;
    return columns * rows * region.extent.depth * region.layers * info.bytes_per_block;
}

}  // namespace lumo::rhi
