#include "backends/gl/pieces.hpp"

namespace lumo::backends::gl::piece {
namespace {

GLint integer_at(GLenum name, GLuint index) {
    GLint value = 0;
    glGetIntegeri_v(name, index, &value);
    return value;
}

GLint integer(GLenum name) {
    GLint value = 0;
    glGetIntegerv(name, &value);
    return value;
}

/// What a host bound whole reads as size 0.
BufferRange read_range(GLenum name, GLenum start, GLenum size, GLuint slot) {
    GLint64 offset = 0, bytes = 0;
    glGetInteger64i_v(start, slot, &offset);
    glGetInteger64i_v(size, slot, &bytes);
    return {GLuint(integer_at(name, slot)), GLintptr(offset), GLsizeiptr(bytes)};
}

void write_range(GLenum target, GLuint slot, const BufferRange& range) {
    if (range.size == 0) {
        glBindBufferBase(target, slot, range.buffer);
    } else {
        glBindBufferRange(target, slot, range.buffer, range.offset, range.size);
    }
}

bool clamps_polygon_offset() {
    return epoxy_gl_version() >= 46 || epoxy_has_gl_extension("GL_ARB_polygon_offset_clamp");
}

struct TextureTarget {
    GLenum target;
    GLenum binding;
};
/// In the order of rhi::Dimension.
constexpr std::array<TextureTarget, TextureAt::targets> texture_targets{{
    {GL_TEXTURE_1D, GL_TEXTURE_BINDING_1D},
    {GL_TEXTURE_2D, GL_TEXTURE_BINDING_2D},
    {GL_TEXTURE_3D, GL_TEXTURE_BINDING_3D},
    {GL_TEXTURE_CUBE_MAP, GL_TEXTURE_BINDING_CUBE_MAP},
    {GL_TEXTURE_1D_ARRAY, GL_TEXTURE_BINDING_1D_ARRAY},
    {GL_TEXTURE_2D_ARRAY, GL_TEXTURE_BINDING_2D_ARRAY},
    {GL_TEXTURE_CUBE_MAP_ARRAY, GL_TEXTURE_BINDING_CUBE_MAP_ARRAY},
    {GL_TEXTURE_2D_MULTISAMPLE, GL_TEXTURE_BINDING_2D_MULTISAMPLE},
}};

struct SubroutineStage {
    GLenum stage;
    GLenum uniforms;
};
constexpr SubroutineStage subroutine_stages[] = {
    {GL_VERTEX_SHADER, GL_VERTEX_SUBROUTINE_UNIFORM},
    {GL_TESS_CONTROL_SHADER, GL_TESS_CONTROL_SUBROUTINE_UNIFORM},
    {GL_TESS_EVALUATION_SHADER, GL_TESS_EVALUATION_SUBROUTINE_UNIFORM},
    {GL_GEOMETRY_SHADER, GL_GEOMETRY_SUBROUTINE_UNIFORM},
    {GL_FRAGMENT_SHADER, GL_FRAGMENT_SUBROUTINE_UNIFORM},
    {GL_COMPUTE_SHADER, GL_COMPUTE_SUBROUTINE_UNIFORM},
};

}  // namespace

Subroutines::Value Subroutines::read(GLuint) {
    const auto whole = GLuint(integer(GL_CURRENT_PROGRAM));
    const auto pipeline = GLuint(integer(GL_PROGRAM_PIPELINE_BINDING));
    Value value;
    for (size_t i = 0; i < value.size(); ++i) {
        const auto [stage, uniforms] = subroutine_stages[i];
        GLint program = GLint(whole), used = 0, locations = 0;
        if (!whole && pipeline) glGetProgramPipelineiv(pipeline, stage, &program);
        if (program) glGetProgramInterfaceiv(GLuint(program), uniforms, GL_ACTIVE_RESOURCES, &used);
        if (!used) continue;
        glGetProgramStageiv(GLuint(program), stage, GL_ACTIVE_SUBROUTINE_UNIFORM_LOCATIONS, &locations);
        value[i].resize(size_t(locations));
        for (GLint location = 0; location < locations; ++location)
            glGetUniformSubroutineuiv(stage, location, &value[i][size_t(location)]);
    }
    return value;
}

void Subroutines::write(GLuint, const Value& value) {
    for (size_t i = 0; i < value.size(); ++i)
        if (!value[i].empty())
            glUniformSubroutinesuiv(subroutine_stages[i].stage, GLsizei(value[i].size()), value[i].data());
}

ClipControl::Value ClipControl::read(GLuint) {
    return {integer(GL_CLIP_ORIGIN), integer(GL_CLIP_DEPTH_MODE)};
}

PolygonOffset::Value PolygonOffset::read(GLuint) {
    Value value{};
    glGetFloatv(GL_POLYGON_OFFSET_FACTOR, &value.factor);
    glGetFloatv(GL_POLYGON_OFFSET_UNITS, &value.units);
    if (clamps_polygon_offset()) glGetFloatv(GL_POLYGON_OFFSET_CLAMP, &value.clamp);
    return value;
}

void PolygonOffset::write(GLuint, Value value) {
    if (value.clamp != 0) {
        glPolygonOffsetClamp(value.factor, value.units, value.clamp);
    } else {
        glPolygonOffset(value.factor, value.units);
    }
}

ViewportBox::Value ViewportBox::read(GLuint index) {
    Value value{};
    glGetFloati_v(GL_VIEWPORT, index, value.data());
    return value;
}

ScissorBox::Value ScissorBox::read(GLuint index) {
    Value value{};
    glGetIntegeri_v(GL_SCISSOR_BOX, index, value.data());
    return value;
}

DepthRange::Value DepthRange::read(GLuint index) {
    Value value{};
    glGetDoublei_v(GL_DEPTH_RANGE, index, value.data());
    return value;
}

ColorMask::Value ColorMask::read(GLuint target) {
    Value value{};
    glGetBooleani_v(GL_COLOR_WRITEMASK, target, value.data());
    return value;
}

BlendFunction::Value BlendFunction::read(GLuint target) {
    return {GLenum(integer_at(GL_BLEND_SRC_RGB, target)), GLenum(integer_at(GL_BLEND_DST_RGB, target)),
            GLenum(integer_at(GL_BLEND_SRC_ALPHA, target)), GLenum(integer_at(GL_BLEND_DST_ALPHA, target))};
}

BlendEquation::Value BlendEquation::read(GLuint target) {
    return {GLenum(integer_at(GL_BLEND_EQUATION_RGB, target)),
            GLenum(integer_at(GL_BLEND_EQUATION_ALPHA, target))};
}

GLuint TextureAt::read(GLuint index) {
    glActiveTexture(GL_TEXTURE0 + index / targets);
    return GLuint(integer(texture_targets[index % targets].binding));
}

void TextureAt::write(GLuint index, GLuint name) {
    if (name) return glBindTextureUnit(index / targets, name);
    // glBindTextureUnit would take the textures of all targets away.
    glActiveTexture(GL_TEXTURE0 + index / targets);
    glBindTexture(texture_targets[index % targets].target, 0);
}

GLuint SamplerAt::read(GLuint unit) {
    glActiveTexture(GL_TEXTURE0 + unit);
    return GLuint(integer(GL_SAMPLER_BINDING));
}

ImageBinding ImageAt::read(GLuint unit) {
    return {.texture = GLuint(integer_at(GL_IMAGE_BINDING_NAME, unit)),
            .mip = integer_at(GL_IMAGE_BINDING_LEVEL, unit),
            .access = GLenum(integer_at(GL_IMAGE_BINDING_ACCESS, unit)),
            .format = GLenum(integer_at(GL_IMAGE_BINDING_FORMAT, unit)),
            .layered = GLboolean(integer_at(GL_IMAGE_BINDING_LAYERED, unit)),
            .layer = integer_at(GL_IMAGE_BINDING_LAYER, unit)};
}

BufferRange StorageAt::read(GLuint slot) {
    return read_range(GL_SHADER_STORAGE_BUFFER_BINDING, GL_SHADER_STORAGE_BUFFER_START,
                      GL_SHADER_STORAGE_BUFFER_SIZE, slot);
}
void StorageAt::write(GLuint slot, const BufferRange& range) {
    write_range(GL_SHADER_STORAGE_BUFFER, slot, range);
}

BufferRange UniformAt::read(GLuint slot) {
    return read_range(GL_UNIFORM_BUFFER_BINDING, GL_UNIFORM_BUFFER_START, GL_UNIFORM_BUFFER_SIZE, slot);
}
void UniformAt::write(GLuint slot, const BufferRange& range) { write_range(GL_UNIFORM_BUFFER, slot, range); }

}  // namespace lumo::backends::gl::piece
