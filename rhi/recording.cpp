#include <algorithm>
#include <fmt/format.h>

#include "rhi/core.hpp"

namespace lumo::rhi {
namespace {

/// Of staged bytes: a multiple of every format's texel.
constexpr uint64_t staging_alignment = 16;
constexpr uint64_t group_arguments = 12;  ///< bytes: three counts

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

size_t hash_of(PipelineHandle pipeline, std::span<const BindingValue> bindings) {
    uint64_t hash = pipeline.index;
    for (const BindingValue& value : bindings) {
        hash +=
            value.view.texture.index + value.view.first_mip + value.slice.buffer.index + value.slice.offset;
        hash *= 0x9e3779b97f4a7c15u;
    }
    return size_t(hash >> 32);
}

Use buffer_use(BufferHandle buffer, Access access) { return {.memory = memory_of(buffer), .access = access}; }

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
    return start_pass(serial, name, blank_pass());
}

void DeviceCore::OpenPass::clear() {
    raster = false;
    targets = {};
    steps.clear();
    uses.clear();
    arena.clear();
    scopes.clear();
    barriers.clear();
}

std::unique_ptr<DeviceCore::OpenPass> DeviceCore::blank_pass() {
    if (!blank_) blank_ = std::make_unique<OpenPass>();
    return std::move(blank_);
}

void DeviceCore::end_pass(uint64_t id) {
    if (!pass_ || pass_->id != id || id == 0) return;
    OpenPass& pass = *pass_;
    EmittedPass emitted{.name = pass.name, .targets = nullptr, .barriers = {}, .steps = pass.steps};
    if (pass.raster) {
        emitted.targets = &pass.targets;
        const auto barriers = enter(pass, {}, pass.uses, false);
        emitted.barriers = {barriers.begin(), barriers.end()};
    }
    if (!lost_ && !idle_) {
        if (auto done = backend_->emit(emitted); !done) refuse(open_serial_, within(pass.name, done.error()));
    }

    records_[open_serial_].passes.push_back(pass.name);
    if (tracing_) keep_trace(pass.scopes, pass.barriers);
    pass.clear();
    blank_ = std::move(pass_);
}

void DeviceCore::keep_trace(std::span<const Scope> scopes, std::span<const std::vector<Barrier>> barriers) {
    std::map<MemoryId, std::string> names;
    for (const Scope& scope : scopes)
        for (const Use& use : scope.uses) names.emplace(use.memory, resources_.name_of(use.memory));
    records_[open_serial_].trace += to_text(scopes, barriers, names);
}

std::span<const Barrier> DeviceCore::enter(OpenPass& pass, std::string_view what, std::span<const Use> uses,
                                           bool unordered) {
    for (const Use& use : uses)
        for (uint32_t mip = 0; mip < resources_.adopted_mips(use.memory); ++mip)
            borrowed_.insert({use.memory.kind, use.memory.index, mip});
    barriers_.clear();
    tracker_.enter(uses, unordered, barriers_);
    if (tracing_) {
        pass.scopes.push_back({.label = what.empty() ? pass.name : fmt::format("{}/{}", pass.name, what),
                               .uses = {uses.begin(), uses.end()},
                               .unordered = unordered});
        pass.barriers.push_back(barriers_);
    }
    return barriers_;
}

void DeviceCore::add(OpenPass& pass, std::string_view what, std::span<const Use> uses, bool unordered,
                     const Command& command) {
    pass.steps.push_back({pass.arena.copy(enter(pass, what, uses, unordered)), command});
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

Verdict DeviceCore::check_set(OpenPass& pass, PipelineHandle handle, std::span<const BindingValue> bindings,
                              BoundSet& set) {
    set = {};
    const PipelineRecord* pipeline = resources_.find(handle);
    if (!pipeline) return stale("a pipeline");
    const ProgramInfo& program = *pipeline->program;
    if (pipeline->raster.has_value() != pass.raster)
        return fault(Check::pipeline_kind, "program \"{}\" in a {} pass", program.name,
                     pass.raster ? "raster" : "compute");
    std::vector<Use>& uses = no_uses();
    for (size_t i = 0; i < bindings.size(); ++i) {
        if (auto bad = bind_one(program.bindings[i], bindings[i], uses)) {
            bad->text = fmt::format("program \"{}\", binding {}: {}", program.name, program.bindings[i].name,
                                    bad->text);
            return bad;
        }
    }
    if (pass.raster)
        if (auto bad = check_draw_targets(pass, *pipeline)) return bad;
    if (const auto memory = merge_uses(uses)) return conflict(*memory);
    set = {.pipeline = handle,
           .program = &program,
           .bindings = pass.arena.copy(bindings),
           .uses = pass.arena.copy(std::span<const Use>(uses)),
           .pass = pass.id,
           .releases = resources_.releases()};
    return {};
}

Verdict DeviceCore::bind(OpenPass& pass, PipelineHandle handle, std::span<const BindingValue> bindings,
                         std::span<const std::byte> push, BoundSet*& bound) {
    BoundSet& set = bound_sets_[hash_of(handle, bindings) % bound_sets_.size()];
    const bool known = set.pass == pass.id && set.releases == resources_.releases() &&
                       set.pipeline == handle && std::ranges::equal(set.bindings, bindings);
    if (!known)
        if (auto bad = check_set(pass, handle, bindings, set)) return bad;
    if (push.size() != set.program->push_size)
        return fault(Check::push_size, "{} bytes for the {} of program \"{}\"", push.size(),
                     set.program->push_size, set.program->name);
    bound = &set;
    return {};
}

// -- compute

Result<void> DeviceCore::dispatch(uint64_t id, PipelineHandle pipeline,
                                  std::span<const BindingValue> bindings, std::span<const std::byte> push,
                                  Groups groups) {
    return record(id, [&](OpenPass& pass) -> Verdict {
        BoundSet* bound = nullptr;
        if (auto bad = bind(pass, pipeline, bindings, push, bound)) return bad;
        const std::string_view program = bound->program->name;
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
        add(pass, program, bound->uses, groups.unordered,
            DispatchCommand{bound->with(pass.arena.copy(push)), groups.x, groups.y, groups.z});
        return {};
    });
}

Result<void> DeviceCore::dispatch_indirect(uint64_t id, PipelineHandle pipeline,
                                           std::span<const BindingValue> bindings,
                                           std::span<const std::byte> push, BufferSlice arguments,
                                           bool unordered) {
    return record(id, [&](OpenPass& pass) -> Verdict {
        BoundSet* bound = nullptr;
        if (auto bad = bind(pass, pipeline, bindings, push, bound)) return bad;
        std::vector<Use>& uses = no_uses();
        uses.assign(bound->uses.begin(), bound->uses.end());
        if (auto bad =
                use_slice(arguments, BufferUsage::indirect, Access::indirect_read, sizeof(uint32_t), uses))
            return bad;
        if (arguments.size < group_arguments)
            return fault(Check::buffer_too_small, "{} bytes of indirect arguments; three counts take {}",
                         arguments.size, group_arguments);
        if (const auto memory = merge_uses(uses)) return conflict(*memory);
        add(pass, bound->program->name, uses, unordered,
            DispatchIndirectCommand{bound->with(pass.arena.copy(push)), arguments});
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
    if (lost_) return tl::unexpected(*lost_);
    if (!recording(serial)) return fail(ErrorKind::invalid_argument, "uniform", "its commands are spent");
    BufferSlice slice;
    if (bytes.empty()) return drop("uniform", {Check::empty_work, "no bytes of uniform data"});
    if (auto bad = stage(bytes, info().limits.uniform_alignment, slice)) return drop("uniform", *bad);
    return slice;
}

Result<void> DeviceCore::copy(uint64_t id, BufferSlice source, BufferSlice destination) {
    return record(id, [&](OpenPass& pass) -> Verdict {
        std::vector<Use>& uses = no_uses();
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
        add(pass, "copy", uses, false, CopyBufferCommand{source, destination});
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
        std::vector<Use>& uses = no_uses();
        if (source == destination && source_region.mip == destination_region.mip) {
            uses = {
                texture_use({.texture = source}, source_region.mip, Access::copy_read | Access::copy_write)};
        } else {
            uses = {texture_use({.texture = source}, source_region.mip, Access::copy_read),
                    texture_use({.texture = destination}, destination_region.mip, Access::copy_write,
                                covers_mip(to->desc, destination_region))};
        }
        add(pass, "copy", uses, false,
            CopyTextureCommand{source, destination, source_region, destination_region});
        return {};
    });
}

Result<void> DeviceCore::upload(uint64_t id, BufferSlice destination, std::span<const std::byte> bytes) {
    return record(id, [&](OpenPass& pass) -> Verdict {
        std::vector<Use>& uses = no_uses();
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
        std::vector<Use>& uses = no_uses();
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
        std::vector<Use>& uses = no_uses();
        for (uint32_t mip = 0; mip < view.mips; ++mip)
            uses.push_back(texture_use(view, view.first_mip + mip, Access::copy_write,
                                       covers_layers(texture->desc, view)));
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
        std::vector<Use>& uses = no_uses();
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

// -- a host's work around a submission

Result<void> DeviceCore::wait_for(uint64_t serial, const NativeSync& sync) {
    if (!recording(serial)) return fail(ErrorKind::invalid_argument, "wait", "its commands are spent");
    if (pass_ || !records_[serial].passes.empty())
        return drop("wait", {Check::sync_order, "the submission has passes already"});
    auto told = lost_ || idle_ ? Result<void>{} : backend_->wait_for(sync);
    if (!told) return drop("wait", {Check::none, to_string(told.error()), told.error().kind});
    return told;
}

Result<void> DeviceCore::signal(uint64_t serial, const NativeSync& sync) {
    if (!recording(serial)) return fail(ErrorKind::invalid_argument, "signal", "its commands are spent");
    auto told = lost_ || idle_ ? Result<void>{} : backend_->signal(sync);
    if (!told) return drop("signal", {Check::none, to_string(told.error()), told.error().kind});
    return told;
}

}  // namespace lumo::rhi
