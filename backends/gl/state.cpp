#include "backends/gl/state.hpp"

#include <cmath>

namespace lumo::backends::gl {
namespace {

// Tables are in the order of their enumerations.

GLenum gl_compare(rhi::Compare compare) {
    static constexpr GLenum compares[] = {GL_NEVER,   GL_LESS,     GL_EQUAL,  GL_LEQUAL,
                                          GL_GREATER, GL_NOTEQUAL, GL_GEQUAL, GL_ALWAYS};
    return compares[size_t(compare)];
}

GLenum gl_factor(rhi::BlendFactor factor) {
    static constexpr GLenum factors[] = {
        GL_ZERO,      GL_ONE,      GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_DST_ALPHA, GL_ONE_MINUS_DST_ALPHA,
        GL_SRC_COLOR, GL_DST_COLOR};
    return factors[size_t(factor)];
}

GLenum gl_blend_op(rhi::BlendOp op) {
    static constexpr GLenum ops[] = {GL_FUNC_ADD, GL_FUNC_SUBTRACT, GL_MIN, GL_MAX};
    return ops[size_t(op)];
}

}  // namespace

void BoundState::forget_objects() {
    visit_all([](auto& piece) {
        if constexpr (std::remove_reference_t<decltype(piece)>::names_objects) piece.forget();
    });
}

void BoundState::give_back() {
    visit_all([](auto& piece) { piece.give_back(); });
    raster_.reset();
}

// -- shaders

void BoundState::program(GLuint name) {
    set<piece::Enabled<GL_TEXTURE_CUBE_MAP_SEAMLESS>>(true);
    if (knows<piece::Program>(name, 0)) return;
    disturb<piece::Subroutines>();
    set<piece::Program>(name);
}

void BoundState::texture(GLuint unit, rhi::Dimension dimension, GLuint name, GLuint sampler) {
    const GLuint index = unit * piece::TextureAt::targets + GLuint(dimension);
    constexpr size_t all = slots * piece::TextureAt::targets;
    if (knows<piece::TextureAt, all>(name, index) && knows<piece::SamplerAt, slots>(sampler, unit)) return;
    disturb<piece::ActiveTexture>();
    set<piece::TextureAt, all>(name, index);
    set<piece::SamplerAt, slots>(sampler, unit);
}

void BoundState::storage(GLuint slot, const BufferRange& range) {
    if (knows<piece::StorageAt, slots>(range, slot)) return;
    disturb<piece::StorageBuffer>();
    set<piece::StorageAt, slots>(range, slot);
}

void BoundState::uniform(GLuint slot, const BufferRange& range) {
    if (knows<piece::UniformAt, slots>(range, slot)) return;
    disturb<piece::UniformBuffer>();
    set<piece::UniformAt, slots>(range, slot);
}

// -- texels

void BoundState::pack(GLuint buffer) {
    set<piece::PackBuffer>(buffer);
    set<piece::PixelStore<GL_PACK_ALIGNMENT>>(1);
    set_all(packing_, 0);
}

void BoundState::unpack(GLuint buffer) {
    set<piece::UnpackBuffer>(buffer);
    set<piece::PixelStore<GL_UNPACK_ALIGNMENT>>(1);
    set_all(unpacking_, 0);
}

// -- raster

void BoundState::raster(const rhi::RasterState& state) {
    if (raster_ == state) return;
    for (GLuint i = 0; i < state.color.size(); ++i) color_target(i, state.color[i]);
    depth(state.depth);
    set<piece::Enabled<GL_CULL_FACE>>(state.cull != rhi::CullMode::none);
    if (state.cull != rhi::CullMode::none)
        set<piece::CullFace>(GLenum(state.cull == rhi::CullMode::front ? GL_FRONT : GL_BACK));
    set<piece::Enabled<GL_DEPTH_CLAMP>>(state.depth_clamp);
    raster_ = state;
}

void BoundState::color_masks(GLuint target, uint8_t bits) {
    const auto mask = [&](int bit) { return GLboolean((bits >> bit) & 1); };
    set<piece::ColorMask, color_targets>({mask(0), mask(1), mask(2), mask(3)}, target);
}

void BoundState::color_target(GLuint target, const rhi::ColorTargetState& state) {
    color_masks(target, state.write_mask);
    set<piece::EnabledAt<GL_BLEND>, color_targets>(state.blend.has_value(), target);
    if (!state.blend) return;
    const rhi::BlendState& blend = *state.blend;
    set<piece::BlendFunction, color_targets>(
        {gl_factor(blend.source_color), gl_factor(blend.destination_color), gl_factor(blend.source_alpha),
         gl_factor(blend.destination_alpha)},
        target);
    set<piece::BlendEquation, color_targets>({gl_blend_op(blend.color_op), gl_blend_op(blend.alpha_op)},
                                             target);
}

void BoundState::depth(const std::optional<rhi::DepthState>& depth) {
    set<piece::Enabled<GL_DEPTH_TEST>>(depth.has_value());
    const bool biased = depth && (depth->bias_constant != 0 || depth->bias_slope != 0);
    set<piece::Enabled<GL_POLYGON_OFFSET_FILL>>(biased);
    if (biased) set<piece::PolygonOffset>({depth->bias_slope, depth->bias_constant, 0});
    if (!depth) return;
    set<piece::DepthMask>(depth->write);
    set<piece::DepthFunction>(gl_compare(depth->compare));
}

void BoundState::open_masks() {
    set_all(unused_, false);
    encode_srgb(true);
    set<piece::Enabled<GL_PROGRAM_POINT_SIZE>>(true);
    set<piece::Enabled<GL_MULTISAMPLE>>(true);
    set<piece::ClipControl>({GL_LOWER_LEFT, GL_ZERO_TO_ONE});
    set<piece::FrontFace>(GL_CCW);
    set<piece::ProvokingVertex>(GL_FIRST_VERTEX_CONVENTION);  // as Vulkan
    set<piece::PolygonMode>(GL_FILL);
    set<piece::LineWidth>(1);
    set<piece::PointFade>(1);
    set<piece::PointOrigin>(GL_UPPER_LEFT);
    set<piece::DepthRange>({0, 1});

    scissor(false);
    for (GLuint i = 0; i < color_targets; ++i) color_masks(i, 0xf);
    set<piece::DepthMask>(GL_TRUE);
    raster_.reset();
}

void BoundState::viewport(const rhi::Viewport& viewport) {
    set<piece::ViewportBox>({viewport.x, viewport.y, viewport.width, viewport.height});
    const auto left = GLint(std::floor(viewport.x)), bottom = GLint(std::floor(viewport.y));
    const auto right = GLint(std::ceil(viewport.x + viewport.width));
    const auto top = GLint(std::ceil(viewport.y + viewport.height));
    set<piece::ScissorBox>({left, bottom, right - left, top - bottom});
    scissor(true);
}

}  // namespace lumo::backends::gl
