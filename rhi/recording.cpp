#include <algorithm>
#include <cstring>
#include <fmt/format.h>

#include "rhi/core.hpp"

namespace lumo::rhi {
namespace {

constexpr uint64_t indirect_alignment = 4;  ///< bytes
/// Of staged bytes: a multiple of every format's texel.
constexpr uint64_t staging_alignment = 16;
constexpr uint64_t group_arguments = 12;  ///< bytes: three counts

uint64_t index_bytes(IndexType type) { return type == IndexType::uint16 ? 2 : 4; }

template <class... Args>
Fault fault(Check check, fmt::format_string<Args...> format, Args&&... args) {
    return {check, fmt::format(format, std::forward<Args>(args)...)};
}

Fault stale(std::string_view what) {
    return fault(Check::stale_handle, "{} that is gone or another device's", what);
}

/// A layout follows from the access and the texture's usage alone, so that descriptors know it as well.
Layout layout_of(Access access, TextureUsage usage) {
    const bool reads_copy = has(access, Access::copy_read);
    const bool writes_copy = has(access, Access::copy_write);
    if (reads_copy && writes_copy) return Layout::general;
    if (reads_copy) return Layout::copy_source;
    if (writes_copy) return Layout::copy_destination;
    if (has(access, Access::color_attachment)) return Layout::color_attachment;
    if (has(access, Access::depth_attachment)) return Layout::depth_attachment;
    return has(usage, TextureUsage::storage) ? Layout::general : Layout::read_only;
}

Access storage_access(ShaderAccess access) {
    switch (access) {
        case ShaderAccess::read:
            return Access::storage_read;
        case ShaderAccess::write:
            return Access::storage_write;
        default:
            return Access::storage_read | Access::storage_write;
    }
}

MemoryId memory_of(BufferHandle buffer) { return {MemoryId::Kind::buffer, buffer.index, 0}; }

Use buffer_use(BufferHandle buffer, Access access) { return {.memory = memory_of(buffer), .access = access}; }

bool covers_mips(const TextureDesc& texture, const TextureView& view) {
    return view.layers == texture.layers;
}

}  // namespace

// -- passes

bool DeviceCore::recording(uint64_t serial) {
    if (serial && serial == open_serial_) return true;
    drop("commands", {Check::commands_spent, "they were submitted, or never begun"});
    return false;
}

uint64_t DeviceCore::start_pass(uint64_t serial, std::string_view name, std::unique_ptr<OpenPass> pass) {
    if (!recording(serial)) return 0;
    if (pass_) {
        drop(name, fault(Check::pass_open, "pass \"{}\" is still open", pass_->name));
        return 0;
    }
    pass->id = ++last_pass_;
    pass->name = name;
    pass_ = std::move(pass);
    return pass_->id;
}

uint64_t DeviceCore::open_pass(uint64_t serial, std::string_view name) {
    return start_pass(serial, name, std::make_unique<OpenPass>());
}

uint64_t DeviceCore::open_raster_pass(uint64_t serial, std::string_view name, const RasterTargets& targets) {
    auto pass = std::make_unique<OpenPass>();
    pass->raster = true;
    pass->targets = targets;
    Verdict bad = check_targets(pass->targets, pass->uses);
    if (!bad) {
        MergedUses merged = merge_uses(pass->uses);
        if (merged.conflict) bad = conflict(merged.conflicting);
        pass->uses = std::move(merged.uses);
    }
    if (bad) {
        drop(name, *bad);
        return 0;
    }
    return start_pass(serial, name, std::move(pass));
}

void DeviceCore::end_pass(uint64_t id) {
    if (!pass_ || pass_->id != id || id == 0) return;
    OpenPass& pass = *pass_;
    EmittedPass emitted{.name = pass.name, .targets = nullptr, .barriers = {}, .steps = pass.steps};
    if (pass.raster) {
        emitted.targets = &pass.targets;
        emitted.barriers = enter(pass, {.label = pass.name, .uses = pass.uses});
    }
    if (!lost_) backend_->emit(emitted);

    Record& record = records_[open_serial_];
    record.passes.push_back(pass.name);
    if (tracing_) {
        std::map<MemoryId, std::string> names;
        for (const Scope& scope : pass.scopes)
            for (const Use& use : scope.uses) names.emplace(use.memory, resources_.name_of(use.memory));
        record.trace += to_text(pass.scopes, pass.barriers, names);
    }
    pass_.reset();
}

std::vector<Barrier> DeviceCore::enter(OpenPass& pass, Scope scope) {
    std::vector<Barrier> barriers = tracker_.enter(scope);
    if (tracing_) {
        pass.scopes.push_back(std::move(scope));
        pass.barriers.push_back(barriers);
    }
    return barriers;
}

void DeviceCore::add(OpenPass& pass, std::string_view what, std::span<const Use> uses, bool unordered,
                     const Command& command) {
    Scope scope{.label = fmt::format("{}/{}", pass.name, what),
                .uses = {uses.begin(), uses.end()},
                .unordered = unordered};
    pass.steps.push_back({enter(pass, std::move(scope)), command});
}

template <class Body>
Result<void> DeviceCore::record(uint64_t id, Body body) {
    if (!pass_ || id == 0 || pass_->id != id)
        return drop("pass", {Check::commands_spent, "it has ended, or could not be opened"});
    Verdict bad = body(*pass_);
    if (bad) return drop(pass_->name, *bad);
    return {};
}

template <class T>
std::span<const T> DeviceCore::keep(OpenPass& pass, std::span<const T> values) {
    if (values.empty()) return {};
    void* memory = pass.arena.allocate(values.size_bytes(), alignof(T));
    std::memcpy(memory, values.data(), values.size_bytes());
    return {static_cast<const T*>(memory), values.size()};
}

// -- what commands touch

Use DeviceCore::texture_use(const TextureView& view, uint32_t mip, Access access, bool discard) {
    return {.memory = {MemoryId::Kind::texture, view.texture.index, mip},
            .access = access,
            .layout = layout_of(access, resources_.find(view.texture)->desc.usage),
            .discard = discard};
}

Verdict DeviceCore::conflict(const MemoryId& memory) const {
    return fault(Check::conflicting_access, "{} is written and used in another way as well",
                 resources_.name_of(memory));
}

Verdict DeviceCore::use_slice(const BufferSlice& slice, BufferUsage usage, Access access, uint64_t alignment,
                              std::vector<Use>& uses) {
    const BufferRecord* buffer = resources_.find(slice.buffer);
    if (!buffer) return stale("a buffer");
    if (auto bad = check_slice(buffer->desc, slice, usage, alignment)) return bad;
    if (!buffer->internal) uses.push_back(buffer_use(slice.buffer, access));
    return {};
}

Verdict DeviceCore::bind_one(const BindingInfo& info, const BindingValue& value, std::vector<Use>& uses) {
    const size_t first = uses.size();
    if (info.kind == BindingKind::storage_buffer || info.kind == BindingKind::uniform_buffer) {
        const BufferRecord* buffer = resources_.find(value.slice.buffer);
        if (!buffer) return stale("a buffer");
        if (buffer->internal && !uploads_.holds(value.slice, open_serial_))
            return fault(Check::stale_handle, "uniform data of an earlier submission");
        if (auto bad = check_buffer_binding(info, buffer->desc, value.slice, this->info().limits)) return bad;
        const bool uniform = info.kind == BindingKind::uniform_buffer;
        if (!buffer->internal)
            uses.push_back(
                buffer_use(value.slice.buffer, uniform ? Access::uniform_read : storage_access(info.access)));
    } else {
        const TextureRecord* texture = resources_.find(value.view.texture);
        if (!texture) return stale("a texture");
        const bool sampled = info.kind == BindingKind::sampled;
        const SamplerRecord* sampler = sampled ? resources_.find(value.sampler) : nullptr;
        if (sampled && !sampler) return stale("a sampler");
        if (auto bad = check_texture_binding(info, texture->desc, value.view, format_caps(value.view.format),
                                             sampled ? &sampler->desc : nullptr))
            return bad;
        const Access access = sampled ? Access::sampled_read : storage_access(info.access);
        for (uint32_t mip = 0; mip < value.view.mips; ++mip)
            uses.push_back(texture_use(value.view, value.view.first_mip + mip, access));
    }
    const bool storage = info.kind == BindingKind::storage_buffer || info.kind == BindingKind::storage_image;
    for (size_t i = first; i < uses.size(); ++i) {
        uses[i].stages = info.stages;
        uses[i].commutative = storage && info.access == ShaderAccess::atomic;
    }
    return {};
}

Verdict DeviceCore::bind(OpenPass& pass, PipelineHandle handle, std::span<const BindingValue> bindings,
                         std::span<const std::byte> push, Bound& bound) {
    const PipelineRecord* pipeline = resources_.find(handle);
    if (!pipeline) return stale("a pipeline");
    const ProgramInfo& program = *pipeline->program;
    if (pipeline->raster.has_value() != pass.raster)
        return fault(Check::pipeline_kind, "program \"{}\" in a {} pass", program.name,
                     pass.raster ? "raster" : "compute");
    if (push.size() != program.push_size)
        return fault(Check::push_size, "{} bytes for the {} of program \"{}\"", push.size(),
                     program.push_size, program.name);
    for (size_t i = 0; i < bindings.size(); ++i) {
        if (auto bad = bind_one(program.bindings[i], bindings[i], bound.uses)) {
            bad->text = fmt::format("program \"{}\", binding {}: {}", program.name, program.bindings[i].name,
                                    bad->text);
            return bad;
        }
    }
    bound.command = {handle, keep(pass, bindings), keep(pass, push)};
    return {};
}

// -- compute

Result<void> DeviceCore::dispatch(uint64_t id, PipelineHandle pipeline,
                                  std::span<const BindingValue> bindings, std::span<const std::byte> push,
                                  Groups groups) {
    return record(id, [&](OpenPass& pass) -> Verdict {
        Bound bound;
        if (auto bad = bind(pass, pipeline, bindings, push, bound)) return bad;
        const std::string_view program = resources_.find(pipeline)->program->name;
        const uint32_t counts[3] = {groups.x, groups.y, groups.z};
        for (int axis = 0; axis < 3; ++axis) {
            if (counts[axis] == 0)
                return fault(Check::empty_work, "program \"{}\": {}x{}x{} groups", program, groups.x,
                             groups.y, groups.z);
            if (counts[axis] > info().limits.max_groups[axis])
                return fault(Check::work_too_large,
                             "program \"{}\": {} groups on axis {}; this device takes {}", program,
                             counts[axis], axis, info().limits.max_groups[axis]);
        }
        const MergedUses merged = merge_uses(bound.uses);
        if (merged.conflict) return conflict(merged.conflicting);
        add(pass, program, merged.uses, groups.unordered,
            DispatchCommand{bound.command, groups.x, groups.y, groups.z});
        return {};
    });
}

Result<void> DeviceCore::dispatch_indirect(uint64_t id, PipelineHandle pipeline,
                                           std::span<const BindingValue> bindings,
                                           std::span<const std::byte> push, BufferSlice arguments,
                                           bool unordered) {
    return record(id, [&](OpenPass& pass) -> Verdict {
        Bound bound;
        if (auto bad = bind(pass, pipeline, bindings, push, bound)) return bad;
        if (auto bad = use_slice(arguments, BufferUsage::indirect, Access::indirect_read, indirect_alignment,
                                 bound.uses))
            return bad;
        if (arguments.size < group_arguments)
            return fault(Check::buffer_too_small, "{} bytes of indirect arguments; three counts take {}",
                         arguments.size, group_arguments);
        const MergedUses merged = merge_uses(bound.uses);
        if (merged.conflict) return conflict(merged.conflicting);
        add(pass, resources_.find(pipeline)->program->name, merged.uses, unordered,
            DispatchIndirectCommand{bound.command, arguments});
        return {};
    });
}

// -- copies

Verdict DeviceCore::stage(std::span<const std::byte> bytes, uint64_t alignment, BufferSlice& slice) {
    auto staged = uploads_.put(bytes, alignment, open_serial_);
    if (!staged) return Fault{Check::none, to_string(staged.error()), staged.error().kind};
    slice = *staged;
    return {};
}

Result<BufferSlice> DeviceCore::uniform(uint64_t serial, std::span<const std::byte> bytes) {
    if (!recording(serial)) return fail(ErrorKind::invalid_argument, "uniform", "its commands are spent");
    BufferSlice slice;
    if (bytes.empty()) return drop("uniform", {Check::empty_work, "no bytes of uniform data"});
    if (auto bad = stage(bytes, info().limits.uniform_alignment, slice)) return drop("uniform", *bad);
    return slice;
}

Result<void> DeviceCore::copy(uint64_t id, BufferSlice source, BufferSlice destination) {
    return record(id, [&](OpenPass& pass) -> Verdict {
        std::vector<Use> uses;
        if (auto bad = use_slice(source, BufferUsage::none, Access::copy_read, 1, uses)) return bad;
        if (auto bad = use_slice(destination, BufferUsage::none, Access::copy_write, 1, uses)) return bad;
        const std::string name = quoted(resources_.find(destination.buffer)->desc.name);
        if (source.size != destination.size)
            return fault(Check::copy_out_of_range, "{} bytes to {} of buffer {}", source.size,
                         destination.size, name);
        if (source.buffer == destination.buffer) {
            if (source.offset < destination.offset + destination.size &&
                destination.offset < source.offset + source.size)
                return fault(Check::copy_overlap, "{} bytes at {} and at {} of buffer {}", source.size,
                             source.offset, destination.offset, name);
            uses = {buffer_use(source.buffer, Access::copy_read | Access::copy_write)};
        }
        add(pass, "copy", merge_uses(uses).uses, false, CopyBufferCommand{source, destination});
        return {};
    });
}

Result<void> DeviceCore::copy(uint64_t id, TextureHandle source, const TextureRegion& source_region,
                              TextureHandle destination, const TextureRegion& destination_region) {
    return record(id, [&](OpenPass& pass) -> Verdict {
        const TextureRecord* from = resources_.find(source);
        const TextureRecord* to = resources_.find(destination);
        if (!from || !to) return stale("a texture");
        if (auto bad =
                check_copy(from->desc, source_region, to->desc, destination_region, source == destination))
            return bad;
        std::vector<Use> uses;
        if (source == destination && source_region.mip == destination_region.mip) {
            uses = {
                texture_use({.texture = source}, source_region.mip, Access::copy_read | Access::copy_write)};
        } else {
            uses = {texture_use({.texture = source}, source_region.mip, Access::copy_read),
                    texture_use({.texture = destination}, destination_region.mip, Access::copy_write,
                                covers_mip(to->desc, destination_region))};
        }
        add(pass, "copy", merge_uses(uses).uses, false,
            CopyTextureCommand{source, destination, source_region, destination_region});
        return {};
    });
}

Result<void> DeviceCore::upload(uint64_t id, BufferSlice destination, std::span<const std::byte> bytes) {
    return record(id, [&](OpenPass& pass) -> Verdict {
        std::vector<Use> uses;
        if (auto bad = use_slice(destination, BufferUsage::none, Access::copy_write, 1, uses)) return bad;
        if (bytes.size() != destination.size)
            return fault(Check::copy_out_of_range, "{} bytes to {} of buffer {}", bytes.size(),
                         destination.size, quoted(resources_.find(destination.buffer)->desc.name));
        BufferSlice source;
        if (auto bad = stage(bytes, staging_alignment, source)) return bad;
        add(pass, "upload", uses, false, CopyBufferCommand{source, destination});
        return {};
    });
}

Result<void> DeviceCore::upload(uint64_t id, TextureHandle destination, const TextureRegion& region,
                                std::span<const std::byte> texels) {
    return record(id, [&](OpenPass& pass) -> Verdict {
        const TextureRecord* texture = resources_.find(destination);
        if (!texture) return stale("a texture");
        if (auto bad = check_region(texture->desc, region)) return bad;
        const uint64_t size = region_bytes(texture->desc.format, region);
        if (texels.size() != size)
            return fault(Check::copy_out_of_range, "{} bytes for a region of {} of texture {}", texels.size(),
                         size, quoted(texture->desc.name));
        BufferSlice source;
        if (auto bad = stage(texels, staging_alignment, source)) return bad;
        const Use use = texture_use({.texture = destination}, region.mip, Access::copy_write,
                                    covers_mip(texture->desc, region));
        add(pass, "upload", {&use, 1}, false, CopyBufferToTextureCommand{source, destination, region});
        return {};
    });
}

Result<void> DeviceCore::fill(uint64_t id, BufferSlice destination, uint32_t value) {
    return record(id, [&](OpenPass& pass) -> Verdict {
        std::vector<Use> uses;
        if (auto bad = use_slice(destination, BufferUsage::none, Access::copy_write, sizeof(value), uses))
            return bad;
        if (destination.size % sizeof(value) != 0)
            return fault(Check::buffer_alignment, "{} bytes of buffer {} are no whole number of words",
                         destination.size, quoted(resources_.find(destination.buffer)->desc.name));
        add(pass, "fill", uses, false, FillBufferCommand{destination, value});
        return {};
    });
}

Result<void> DeviceCore::clear(uint64_t id, const TextureView& view, const ClearValue& value) {
    return record(id, [&](OpenPass& pass) -> Verdict {
        const TextureRecord* texture = resources_.find(view.texture);
        if (!texture) return stale("a texture");
        if (auto bad = check_view(texture->desc, view)) return bad;
        const FormatInfo& format = format_info(view.format);
        const std::string name = quoted(texture->desc.name);
        if (format.block_side > 1)
            return fault(Check::format_unsupported, "texture {} of format {} cannot be cleared", name,
                         format.name);
        const auto typed = clear_for(view.format, value);
        if (!typed)
            return fault(Check::texel_kind, "the value to clear texture {} with does not fit {}", name,
                         format.name);
        // Vulkan clears in the texture's own format; zero is the same bits in all of them.
        if (view.format != texture->desc.format && !is_zero(value))
            return fault(Check::view_format, "texture {} can be cleared to zero alone through a view as {}",
                         name, format.name);
        std::vector<Use> uses;
        for (uint32_t mip = 0; mip < view.mips; ++mip)
            uses.push_back(texture_use(view, view.first_mip + mip, Access::copy_write,
                                       covers_mips(texture->desc, view)));
        add(pass, "clear", uses, false, ClearTextureCommand{view, *typed});
        return {};
    });
}

Result<void> DeviceCore::generate_mips(uint64_t id, TextureHandle handle) {
    return record(id, [&](OpenPass& pass) -> Verdict {
        const TextureRecord* texture = resources_.find(handle);
        if (!texture) return stale("a texture");
        const TextureDesc& desc = texture->desc;
        const FormatInfo& format = format_info(desc.format);
        const FormatCaps caps = format_caps(desc.format);
        if (format.kind == FormatKind::depth || desc.samples > 1 || !has(caps, FormatCaps::linear_filter) ||
            !has(caps, FormatCaps::attachment))
            return fault(Check::format_unsupported, "mips of texture {} of format {} cannot be filtered",
                         quoted(desc.name), format.name);
        for (uint32_t mip = 0; mip + 1 < desc.mips; ++mip) {
            const Use uses[] = {texture_use({.texture = handle}, mip, Access::copy_read),
                                texture_use({.texture = handle}, mip + 1, Access::copy_write, true)};
            add(pass, "mips", uses, false, BlitMipCommand{handle, mip});
        }
        return {};
    });
}

Result<Readback> DeviceCore::read(uint64_t id, BufferSlice source) {
    Result<Readback> ticket;
    auto recorded = record(id, [&](OpenPass& pass) -> Verdict {
        std::vector<Use> uses;
        if (auto bad = use_slice(source, BufferUsage::none, Access::copy_read, 1, uses)) return bad;
        ticket = readbacks_.open(source.size, open_serial_);
        if (!ticket) return Fault{Check::none, to_string(ticket.error()), ticket.error().kind};
        add(pass, "read", uses, false, CopyBufferCommand{source, readbacks_.find(*ticket)->slice});
        return {};
    });
    return recorded.and_then([&] { return ticket; });
}

Result<Readback> DeviceCore::read(uint64_t id, TextureHandle source, const TextureRegion& region) {
    Result<Readback> ticket;
    auto recorded = record(id, [&](OpenPass& pass) -> Verdict {
        const TextureRecord* texture = resources_.find(source);
        if (!texture) return stale("a texture");
        if (auto bad = check_region(texture->desc, region)) return bad;
        ticket = readbacks_.open(region_bytes(texture->desc.format, region), open_serial_);
        if (!ticket) return Fault{Check::none, to_string(ticket.error()), ticket.error().kind};
        const Use use = texture_use({.texture = source}, region.mip, Access::copy_read);
        add(pass, "read", {&use, 1}, false,
            CopyTextureToBufferCommand{source, region, readbacks_.find(*ticket)->slice});
        return {};
    });
    return recorded.and_then([&] { return ticket; });
}

// -- presenting

Result<void> DeviceCore::present(uint64_t serial, TextureHandle handle, bool vsync) {
    const uint64_t id = open_pass(serial, "present");
    if (!id) return fail(ErrorKind::invalid_argument, "present", "its pass could not be opened");
    auto recorded = record(id, [&](OpenPass& pass) -> Verdict {
        const TextureRecord* texture = resources_.find(handle);
        if (!texture) return stale("a texture");
        const TextureDesc& desc = texture->desc;
        const FormatInfo& format = format_info(desc.format);
        if (!info().window) return fault(Check::not_presentable, "the device was made without a window");
        if (presented_) return fault(Check::not_presentable, "a submission presents once");
        if (desc.dimension != Dimension::d2 || format.kind == FormatKind::depth ||
            texel_kind(desc.format) != TexelKind::floating ||
            !has(format_caps(desc.format), FormatCaps::attachment))
            return fault(Check::not_presentable, "texture {} of format {} is no picture of two dimensions",
                         quoted(desc.name), format.name);
        presented_ = true;
        const Use use = texture_use({.texture = handle}, 0, Access::copy_read);
        add(pass, "copy", {&use, 1}, false, PresentCommand{handle, vsync});
        return {};
    });
    end_pass(id);
    return recorded;
}

// -- raster

Verdict DeviceCore::check_targets(RasterTargets& targets, std::vector<Use>& uses) {
    struct Shape {
        Extent extent;
        uint32_t layers;
        uint32_t samples;
        bool operator==(const Shape&) const = default;
    };
    std::optional<Shape> shape;
    const Limits& limits = info().limits;
    if (targets.color.size() > limits.max_color_targets)
        return fault(Check::work_too_large, "{} colour targets; this device takes {}", targets.color.size(),
                     limits.max_color_targets);

    const auto add_target = [&](const TextureView& view, Load load, bool depth) -> Verdict {
        const TextureRecord* texture = resources_.find(view.texture);
        if (!texture) return stale("a target");
        if (auto bad = check_target(texture->desc, view, format_caps(view.format), depth)) return bad;
        Extent extent = mip_extent(texture->desc.extent, view.first_mip);
        const Shape own{extent, view.layers, texture->desc.samples};
        if (shape && *shape != own)
            return fault(Check::pipeline_targets,
                         "target {} has {}x{} texels, {} layers, {} samples beside {}x{}, {}, {}",
                         quoted(texture->desc.name), extent.width, extent.height, own.layers, own.samples,
                         shape->extent.width, shape->extent.height, shape->layers, shape->samples);
        shape = own;
        uses.push_back(texture_use(view, view.first_mip,
                                   depth ? Access::depth_attachment : Access::color_attachment,
                                   load != Load::keep && covers_mips(texture->desc, view)));
        return {};
    };
    for (ColorTarget& target : targets.color) {
        if (auto bad = add_target(target.view, target.load, false)) return bad;
        const auto typed = clear_for(target.view.format, target.clear);
        if (target.load == Load::clear && !typed)
            return fault(Check::texel_kind, "the value to clear texture {} with does not fit {}",
                         quoted(resources_.find(target.view.texture)->desc.name),
                         format_info(target.view.format).name);
        if (typed) target.clear = *typed;
    }
    if (targets.depth)
        if (auto bad = add_target(targets.depth->view, targets.depth->load, true)) return bad;

    for (const ColorTarget& target : targets.color) {
        if (!target.resolve) continue;
        const TextureRecord* texture = resources_.find(target.resolve->texture);
        if (!texture) return stale("a resolve target");
        const TextureDesc& desc = texture->desc;
        if (auto bad = check_target(desc, *target.resolve, format_caps(target.resolve->format), false))
            return bad;
        const Shape own{mip_extent(desc.extent, target.resolve->first_mip), target.resolve->layers,
                        shape->samples};
        if (desc.samples != 1 || shape->samples == 1 || own != *shape ||
            target.resolve->format != target.view.format)
            return fault(
                Check::pipeline_targets,
                "texture {} cannot take the average of {}: it needs its size, layers and format, and "
                "one sample of several",
                quoted(desc.name), quoted(resources_.find(target.view.texture)->desc.name));
        if (texel_kind(target.view.format) != TexelKind::floating)
            return fault(Check::format_unsupported, "integers of texture {} have no average",
                         quoted(desc.name));
        uses.push_back(texture_use(*target.resolve, target.resolve->first_mip, Access::color_attachment,
                                   covers_mips(desc, *target.resolve)));
    }
    if (shape) {
        targets.extent = shape->extent;
        targets.samples = shape->samples;
    }
    targets.extent.depth = 1;
    if (targets.extent.width == 0 || targets.extent.height == 0)
        return fault(Check::empty_work, "targets of {}x{} texels", targets.extent.width,
                     targets.extent.height);
    if (std::max(targets.extent.width, targets.extent.height) > limits.max_texture_side_2d)
        return fault(Check::work_too_large, "targets of {}x{} texels; this device takes {} a side",
                     targets.extent.width, targets.extent.height, limits.max_texture_side_2d);
    return {};
}

Verdict DeviceCore::check_draw_targets(const OpenPass& pass, const PipelineRecord& pipeline) const {
    const RasterState& state = *pipeline.raster;
    const RasterTargets& targets = pass.targets;
    const auto differ = [&](std::string what) {
        return fault(Check::pipeline_targets, "the pipeline of program \"{}\" {}", pipeline.program->name,
                     what);
    };
    if (state.color.size() != targets.color.size())
        return differ(
            fmt::format("has {} colour targets and the pass {}", state.color.size(), targets.color.size()));
    for (size_t i = 0; i < state.color.size(); ++i)
        if (state.color[i].format != targets.color[i].view.format)
            return differ(fmt::format("draws into {} and colour target {} is {}",
                                      format_info(state.color[i].format).name, i,
                                      format_info(targets.color[i].view.format).name));
    if (state.depth.has_value() != targets.depth.has_value())
        return differ(state.depth ? "has a depth target and the pass none"
                                  : "has no depth target and the pass one");
    if (state.depth && state.depth->format != targets.depth->view.format)
        return differ("has a depth target of another format");
    if (state.samples != targets.samples)
        return differ(fmt::format("has {} samples and the pass {}", state.samples, targets.samples));
    return {};
}

Verdict DeviceCore::use_draw(const Draw& draw, const PipelineBindings& what, std::vector<Use>&,
                             Command& command) {
    if (draw.vertices == 0 || draw.instances == 0)
        return fault(Check::empty_work, "{} vertices, {} instances", draw.vertices, draw.instances);
    command = DrawCommand{what, draw.vertices, draw.instances, draw.first_vertex};
    return {};
}

Verdict DeviceCore::use_draw(const DrawIndexed& draw, const PipelineBindings& what, std::vector<Use>& uses,
                             Command& command) {
    const uint64_t size = index_bytes(draw.type);
    if (draw.count == 0 || draw.instances == 0)
        return fault(Check::empty_work, "{} indices, {} instances", draw.count, draw.instances);
    if (auto bad = use_slice(draw.indices, BufferUsage::index, Access::index_read, size, uses)) return bad;
    if ((uint64_t{draw.first} + draw.count) * size > draw.indices.size)
        return fault(Check::buffer_out_of_range, "{} indices from {} in {} bytes of buffer {}", draw.count,
                     draw.first, draw.indices.size, quoted(resources_.find(draw.indices.buffer)->desc.name));
    command = DrawIndexedCommand{what,           draw.indices, draw.type,         draw.count,
                                 draw.instances, draw.first,   draw.vertex_offset};
    return {};
}

Verdict DeviceCore::use_draw(const DrawIndirect& draw, const PipelineBindings& what, std::vector<Use>& uses,
                             Command& command) {
    const bool indexed = bool(draw.indices.buffer);
    const uint32_t stride = indexed ? 20 : 16;
    if (draw.draws == 0) return fault(Check::empty_work, "0 indirect draws");
    if (auto bad =
            use_slice(draw.arguments, BufferUsage::indirect, Access::indirect_read, indirect_alignment, uses))
        return bad;
    if (draw.arguments.size < uint64_t{stride} * draw.draws)
        return fault(Check::buffer_too_small, "{} bytes of arguments for {} draws of {}", draw.arguments.size,
                     draw.draws, stride);
    if (indexed) {
        if (auto bad =
                use_slice(draw.indices, BufferUsage::index, Access::index_read, index_bytes(draw.type), uses))
            return bad;
        if (draw.indices.offset != 0)
            return fault(Check::buffer_alignment, "indices of an indirect draw at offset {} of buffer {}",
                         draw.indices.offset, quoted(resources_.find(draw.indices.buffer)->desc.name));
    }
    command = DrawIndirectCommand{what, draw.arguments, draw.draws, stride, draw.indices, draw.type};
    return {};
}

template <class AnyDraw>
Result<void> DeviceCore::draw(uint64_t id, PipelineHandle pipeline, std::span<const BindingValue> bindings,
                              std::span<const std::byte> push, const AnyDraw& draw) {
    return record(id, [&](OpenPass& pass) -> Verdict {
        Bound bound;
        Command command;
        if (auto bad = bind(pass, pipeline, bindings, push, bound)) return bad;
        if (auto bad = check_draw_targets(pass, *resources_.find(pipeline))) return bad;
        if (auto bad = std::visit(
                [&](const auto& one) { return use_draw(one, bound.command, bound.uses, command); }, draw))
            return bad;
        MergedUses merged = merge_uses(bound.uses);
        if (merged.conflict) return conflict(merged.conflicting);
        merged.uses.insert(merged.uses.end(), pass.uses.begin(), pass.uses.end());
        merged = merge_uses(merged.uses, Sharing::draws);
        if (merged.conflict) return conflict(merged.conflicting);
        pass.uses = std::move(merged.uses);
        pass.steps.push_back({{}, command});
        return {};
    });
}

Result<void> DeviceCore::viewport(uint64_t id, const Viewport& viewport) {
    return record(id, [&](OpenPass& pass) -> Verdict {
        const Extent& extent = pass.targets.extent;
        if (!(viewport.width > 0 && viewport.height > 0))
            return fault(Check::empty_work, "a viewport of {}x{}", viewport.width, viewport.height);
        if (!(viewport.x >= 0 && viewport.y >= 0 && viewport.x + viewport.width <= float(extent.width) &&
              viewport.y + viewport.height <= float(extent.height)))
            return fault(Check::view_out_of_range, "a viewport of {}x{} at {},{} on targets of {}x{}",
                         viewport.width, viewport.height, viewport.x, viewport.y, extent.width,
                         extent.height);
        pass.steps.push_back({{}, ViewportCommand{viewport}});
        return {};
    });
}

// -- Commands and passes as their users see them

Commands::~Commands() {
    if (serial_) core_->submit(serial_);
}

Pass Commands::pass(std::string_view name) {
    const uint64_t id = core_->open_pass(serial_, name);
    return {id ? core_ : nullptr, id};
}

RasterPass Commands::raster_pass(std::string_view name, const RasterTargets& targets) {
    const uint64_t id = core_->open_raster_pass(serial_, name, targets);
    return {id ? core_ : nullptr, id};
}

UniformBuffer Commands::uniform_bytes(std::span<const std::byte> bytes) {
    return core_->uniform(serial_, bytes).value_or(BufferSlice{});
}

void Commands::present(const Texture& texture, bool vsync) {
    (void)core_->present(serial_, texture.handle(), vsync);
}

void PassBase::end() {
    if (id_) core_->end_pass(std::exchange(id_, 0));
}

void Pass::copy(BufferSlice source, BufferSlice destination) {
    if (core_) (void)core_->copy(id_, source, destination);
}

void Pass::copy(const Texture& source, const TextureRegion& source_region, const Texture& destination,
                const TextureRegion& destination_region) {
    if (core_)
        (void)core_->copy(id_, source.handle(), source_region, destination.handle(), destination_region);
}

void Pass::upload(BufferSlice destination, std::span<const std::byte> bytes) {
    if (core_) (void)core_->upload(id_, destination, bytes);
}

void Pass::upload(const Texture& destination, const TextureRegion& region,
                  std::span<const std::byte> texels) {
    if (core_) (void)core_->upload(id_, destination.handle(), region, texels);
}

void Pass::fill(BufferSlice destination, uint32_t value) {
    if (core_) (void)core_->fill(id_, destination, value);
}

void Pass::clear(const TextureView& view, const ClearValue& value) {
    if (core_) (void)core_->clear(id_, view, value);
}

void Pass::generate_mips(const Texture& texture) {
    if (core_) (void)core_->generate_mips(id_, texture.handle());
}

Readback Pass::read(BufferSlice source) {
    return core_ ? core_->read(id_, source).value_or(Readback{}) : Readback{};
}

Readback Pass::read(const Texture& source, const TextureRegion& region) {
    return core_ ? core_->read(id_, source.handle(), region).value_or(Readback{}) : Readback{};
}

void Pass::dispatch(PipelineHandle pipeline, std::span<const BindingValue> bindings,
                    std::span<const std::byte> push, Groups groups) {
    if (core_) (void)core_->dispatch(id_, pipeline, bindings, push, groups);
}

void Pass::dispatch_indirect(PipelineHandle pipeline, std::span<const BindingValue> bindings,
                             std::span<const std::byte> push, BufferSlice arguments, bool unordered) {
    if (core_) (void)core_->dispatch_indirect(id_, pipeline, bindings, push, arguments, unordered);
}

void RasterPass::viewport(const Viewport& viewport) {
    if (core_) (void)core_->viewport(id_, viewport);
}

void RasterPass::record(PipelineHandle pipeline, std::span<const BindingValue> bindings,
                        std::span<const std::byte> push, const AnyDraw& draw) {
    if (core_) (void)core_->draw(id_, pipeline, bindings, push, draw);
}

}  // namespace lumo::rhi
