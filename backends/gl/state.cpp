#include "backends/gl/state.hpp"

#include <cmath>

namespace lumo::backends::gl {
namespace {

/// True, and remembered, when `value` was not known to be there.
template <class T>
bool changes(std::optional<T>& known, const T& value) {
    if (known == value) return false;
    known = value;
    return true;
}

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

void enable(GLenum what, bool on) { on ? glEnable(what) : glDisable(what); }

void apply_color(GLuint target, const rhi::ColorTargetState& state) {
    const auto mask = [&](int bit) { return GLboolean((state.write_mask >> bit) & 1); };
    glColorMaski(target, mask(0), mask(1), mask(2), mask(3));
    if (!state.blend) {
        glDisablei(GL_BLEND, target);
        return;
    }
    const rhi::BlendState& blend = *state.blend;
    glEnablei(GL_BLEND, target);
    glBlendFuncSeparatei(target, gl_factor(blend.source_color), gl_factor(blend.destination_color),
                         gl_factor(blend.source_alpha), gl_factor(blend.destination_alpha));
    glBlendEquationSeparatei(target, gl_blend_op(blend.color_op), gl_blend_op(blend.alpha_op));
}

void apply_depth(const std::optional<rhi::DepthState>& depth) {
    enable(GL_DEPTH_TEST, depth.has_value());
    if (!depth) return;
    glDepthMask(depth->write);
    glDepthFunc(gl_compare(depth->compare));
    enable(GL_POLYGON_OFFSET_FILL, depth->bias_constant != 0 || depth->bias_slope != 0);
    glPolygonOffset(depth->bias_slope, depth->bias_constant);
}

void apply_cull(rhi::CullMode cull) {
    enable(GL_CULL_FACE, cull != rhi::CullMode::none);
    glCullFace(cull == rhi::CullMode::front ? GL_FRONT : GL_BACK);
}

bool leaves_masks_open(const rhi::RasterState& state) {
    for (const rhi::ColorTargetState& target : state.color) {
        if (target.write_mask != 0xf) return false;
    }
    return !state.depth || state.depth->write;
}

}  // namespace

void BoundState::forget() { *this = {}; }

void BoundState::program(GLuint name) {
    if (changes(program_, name)) glUseProgram(name);
}

void BoundState::framebuffer(GLuint name) {
    if (changes(framebuffer_, name)) glBindFramebuffer(GL_FRAMEBUFFER, name);
}

void BoundState::texture(GLuint unit, GLuint name, GLuint sampler) {
    const auto known = textures_[unit];
    if (!changes(textures_[unit], {name, sampler})) return;
    if (!known || known->texture != name) glBindTextureUnit(unit, name);
    if (!known || known->sampler != sampler) glBindSampler(unit, sampler);
}

void BoundState::image(GLuint unit, const ImageBinding& image) {
    // Layered always: OpenGL ignores it for textures without layers, and views hold just the layers wanted.
    if (changes(images_[unit], image)) {
        glBindImageTexture(unit, image.texture, image.mip, GL_TRUE, 0, image.access, image.format);
    }
}

void BoundState::storage(GLuint slot, const BufferRange& range) {
    if (changes(storage_[slot], range)) {
        glBindBufferRange(GL_SHADER_STORAGE_BUFFER, slot, range.buffer, range.offset, range.size);
    }
}

void BoundState::uniform(GLuint slot, const BufferRange& range) {
    if (changes(uniforms_[slot], range)) {
        glBindBufferRange(GL_UNIFORM_BUFFER, slot, range.buffer, range.offset, range.size);
    }
}

void BoundState::buffer(GLenum target, GLuint name) {
    auto& known = target == GL_DRAW_INDIRECT_BUFFER       ? draw_indirect_
                  : target == GL_DISPATCH_INDIRECT_BUFFER ? dispatch_indirect_
                  : target == GL_PIXEL_PACK_BUFFER        ? pack_
                                                          : unpack_;
    if (changes(known, name)) glBindBuffer(target, name);
}

void BoundState::raster(const rhi::RasterState& state) {
    const auto known = raster_;
    if (!changes(raster_, state)) return;
    for (GLuint i = 0; i < state.color.size(); ++i) {
        const bool same = known && i < known->color.size() && known->color[i] == state.color[i];
        if (!same) apply_color(i, state.color[i]);
    }
    if (!known || known->depth != state.depth) apply_depth(state.depth);
    if (!known || known->cull != state.cull) apply_cull(state.cull);
    if (!known || known->depth_clamp != state.depth_clamp) enable(GL_DEPTH_CLAMP, state.depth_clamp);
    if (!leaves_masks_open(state)) masks_open_ = false;
}

void BoundState::open_masks() {
    if (changes(scissor_, false)) glDisable(GL_SCISSOR_TEST);
    if (!changes(masks_open_, true)) return;
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glDepthMask(GL_TRUE);
    raster_.reset();
}

void BoundState::viewport(const rhi::Viewport& viewport) {
    if (changes(scissor_, true)) glEnable(GL_SCISSOR_TEST);
    glViewportIndexedf(0, viewport.x, viewport.y, viewport.width, viewport.height);
    const auto left = GLint(std::floor(viewport.x)), bottom = GLint(std::floor(viewport.y));
    const auto right = GLint(std::ceil(viewport.x + viewport.width));
    const auto top = GLint(std::ceil(viewport.y + viewport.height));
    glScissor(left, bottom, right - left, top - bottom);
}

}  // namespace lumo::backends::gl
