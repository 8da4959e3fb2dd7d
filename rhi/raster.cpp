// Raster passes: their targets and draws. All draws of a pass are one scope.
#include <algorithm>

#include "rhi/core.hpp"

namespace lumo::rhi {
namespace {

uint64_t index_bytes(IndexType type) { return type == IndexType::uint16 ? 2 : 4; }

}  // namespace

uint64_t DeviceCore::open_raster_pass(uint64_t serial, std::string_view name, const RasterTargets& targets) {
    auto pass = blank_pass();
    pass->raster = true;
    pass->targets = targets;
    Verdict bad = check_targets(pass->targets, pass->uses);
    if (!bad) {
        if (const auto memory = merge_uses(pass->uses)) bad = conflict(*memory);
    }
    if (bad) {
        pass->clear();
        blank_ = std::move(pass);
        drop(name, *bad);
        return 0;
    }
    return start_pass(serial, name, std::move(pass));
}

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
                                   load != Load::keep && covers_layers(texture->desc, view)));
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
                                   covers_layers(desc, *target.resolve)));
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
            use_slice(draw.arguments, BufferUsage::indirect, Access::indirect_read, sizeof(uint32_t), uses))
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

Result<void> DeviceCore::draw(uint64_t id, PipelineHandle pipeline, std::span<const BindingValue> bindings,
                              std::span<const std::byte> push, const AnyDraw& draw) {
    return record(id, [&](OpenPass& pass) -> Verdict {
        BoundSet* bound = nullptr;
        if (auto bad = bind(pass, pipeline, bindings, push, bound)) return bad;
        std::vector<Use>& uses = no_uses();
        Command command;
        const PipelineBindings what = bound->with(pass.arena.copy(push));
        if (auto bad = std::visit([&](const auto& one) { return use_draw(one, what, uses, command); }, draw))
            return bad;
        if (!bound->joined) uses.insert(uses.end(), bound->uses.begin(), bound->uses.end());
        if (!uses.empty()) {
            if (const auto memory = merge_uses(uses)) return conflict(*memory);
            if (const auto memory = merge_draw(pass.uses, uses)) return conflict(*memory);
        }
        bound->joined = bound->joined || may_repeat(bound->uses);
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

}  // namespace lumo::rhi
