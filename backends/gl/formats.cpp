#include "backends/gl/formats.hpp"

#include <array>

namespace lumo::backends::gl {

using rhi::Dimension;
using rhi::Format;
using rhi::FormatCaps;

// Tables are in the order of their enumerations.

const GlFormat& gl_format(Format format) {
    static constexpr std::array<GlFormat, rhi::format_count> table{{
        {},
        {GL_R8, GL_RED, GL_UNSIGNED_BYTE},
        {GL_RG8, GL_RG, GL_UNSIGNED_BYTE},
        {GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE},
        {GL_SRGB8_ALPHA8, GL_RGBA, GL_UNSIGNED_BYTE},
        {GL_RGBA8UI, GL_RGBA_INTEGER, GL_UNSIGNED_BYTE},
        {GL_RGB10_A2, GL_RGBA, GL_UNSIGNED_INT_2_10_10_10_REV},
        {GL_R11F_G11F_B10F, GL_RGB, GL_UNSIGNED_INT_10F_11F_11F_REV},
        {GL_R16UI, GL_RED_INTEGER, GL_UNSIGNED_SHORT},
        {GL_R16F, GL_RED, GL_HALF_FLOAT},
        {GL_RG16F, GL_RG, GL_HALF_FLOAT},
        {GL_RGBA16F, GL_RGBA, GL_HALF_FLOAT},
        {GL_RGBA16, GL_RGBA, GL_UNSIGNED_SHORT},
        {GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT},
        {GL_R32I, GL_RED_INTEGER, GL_INT},
        {GL_R32F, GL_RED, GL_FLOAT},
        {GL_RG32UI, GL_RG_INTEGER, GL_UNSIGNED_INT},
        {GL_RG32F, GL_RG, GL_FLOAT},
        {GL_RGBA32UI, GL_RGBA_INTEGER, GL_UNSIGNED_INT},
        {GL_RGBA32F, GL_RGBA, GL_FLOAT},
        {GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT, GL_FLOAT},
        {GL_COMPRESSED_SRGB_ALPHA_S3TC_DXT1_EXT, GL_NONE, GL_NONE},
        {GL_COMPRESSED_SRGB_ALPHA_S3TC_DXT5_EXT, GL_NONE, GL_NONE},
        {GL_COMPRESSED_RED_RGTC1, GL_NONE, GL_NONE},
        {GL_COMPRESSED_RG_RGTC2, GL_NONE, GL_NONE},
        {GL_COMPRESSED_RGB_BPTC_UNSIGNED_FLOAT, GL_NONE, GL_NONE},
        {GL_COMPRESSED_RGBA_BPTC_UNORM, GL_NONE, GL_NONE},
        {GL_COMPRESSED_SRGB_ALPHA_BPTC_UNORM, GL_NONE, GL_NONE},
    }};
    return table[size_t(format)];
}

FormatCaps query_caps(Format format) {
    const GLenum internal = gl_format(format).internal;
    if (internal == GL_NONE) return FormatCaps::none;
    auto ask = [internal](GLenum what) {
        GLint answer = GL_NONE;
        glGetInternalformativ(GL_TEXTURE_2D, internal, what, 1, &answer);
        return answer != GL_NONE;
    };
    if (!ask(GL_INTERNALFORMAT_SUPPORTED)) return FormatCaps::none;

    FormatCaps caps = FormatCaps::sampled;
    auto add = [&](bool has, FormatCaps cap) {
        if (has) caps |= cap;
    };
    const bool compressed = gl_format(format).transfer == GL_NONE;
    const rhi::FormatKind kind = rhi::format_info(format).kind;
    const bool integer = kind == rhi::FormatKind::uint || kind == rhi::FormatKind::sint;
    // Vulkan drivers need not filter depth, so nothing may rely on it.
    add(!integer && kind != rhi::FormatKind::depth && ask(GL_FILTER), FormatCaps::linear_filter);
    if (compressed) return caps;
    // The specification's table of image formats has neither sRGB nor depth, whatever a driver answers.
    const bool image = kind != rhi::FormatKind::srgb && kind != rhi::FormatKind::depth;
    add(image && ask(GL_SHADER_IMAGE_LOAD) && ask(GL_SHADER_IMAGE_STORE), FormatCaps::storage);
    add(format == Format::r32_uint || format == Format::r32_sint, FormatCaps::storage_atomic);
    const bool attachment = ask(GL_FRAMEBUFFER_RENDERABLE);
    add(attachment, FormatCaps::attachment);
    add(attachment && !integer && kind != rhi::FormatKind::depth && ask(GL_FRAMEBUFFER_BLEND),
        FormatCaps::blend);
    GLint samples = 0;
    glGetInternalformativ(GL_TEXTURE_2D_MULTISAMPLE, internal, GL_SAMPLES, 1, &samples);
    add(attachment && samples > 1, FormatCaps::multisample);
    return caps;
}

GLenum gl_target(Dimension dimension) {
    static constexpr GLenum targets[] = {GL_TEXTURE_1D,
                                         GL_TEXTURE_2D,
                                         GL_TEXTURE_3D,
                                         GL_TEXTURE_CUBE_MAP,
                                         GL_TEXTURE_1D_ARRAY,
                                         GL_TEXTURE_2D_ARRAY,
                                         GL_TEXTURE_CUBE_MAP_ARRAY,
                                         GL_TEXTURE_2D_MULTISAMPLE};
    return targets[size_t(dimension)];
}

Box gl_box(Dimension dimension, const rhi::TextureRegion& region) {
    const rhi::Extent& extent = region.extent;
    Box box{GLint(region.x),       GLint(region.y),        GLint(region.z),
            GLsizei(extent.width), GLsizei(extent.height), GLsizei(extent.depth)};
    if (dimension == Dimension::d1_array) {
        box.y = GLint(region.first_layer);
        box.height = GLsizei(region.layers);
    } else if (dimension != Dimension::d3 && is_layered(dimension)) {
        box.z = GLint(region.first_layer);
        box.depth = GLsizei(region.layers);
    }
    return box;
}

}  // namespace lumo::backends::gl
