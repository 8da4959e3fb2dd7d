#include "backends/gl/formats.hpp"

#include <array>

namespace lumo::backends::gl {

using rhi::Dimension;
using rhi::Format;
using rhi::FormatCaps;

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
    add(!integer && ask(GL_FILTER), FormatCaps::linear_filter);
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
    switch (dimension) {
        case Dimension::d1:
            return GL_TEXTURE_1D;
        case Dimension::d2:
            return GL_TEXTURE_2D;
        case Dimension::d3:
            return GL_TEXTURE_3D;
        case Dimension::cube:
            return GL_TEXTURE_CUBE_MAP;
        case Dimension::d1_array:
            return GL_TEXTURE_1D_ARRAY;
        case Dimension::d2_array:
            return GL_TEXTURE_2D_ARRAY;
        case Dimension::cube_array:
            return GL_TEXTURE_CUBE_MAP_ARRAY;
        case Dimension::d2_multisample:
            return GL_TEXTURE_2D_MULTISAMPLE;
    }
    return GL_NONE;
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

GLenum gl_topology(rhi::Topology topology) {
    switch (topology) {
        case rhi::Topology::triangles:
            return GL_TRIANGLES;
        case rhi::Topology::triangle_strip:
            return GL_TRIANGLE_STRIP;
        case rhi::Topology::lines:
            return GL_LINES;
        case rhi::Topology::points:
            return GL_POINTS;
    }
    return GL_NONE;
}

GLenum gl_compare(rhi::Compare compare) {
    switch (compare) {
        case rhi::Compare::never:
            return GL_NEVER;
        case rhi::Compare::less:
            return GL_LESS;
        case rhi::Compare::equal:
            return GL_EQUAL;
        case rhi::Compare::less_equal:
            return GL_LEQUAL;
        case rhi::Compare::greater:
            return GL_GREATER;
        case rhi::Compare::not_equal:
            return GL_NOTEQUAL;
        case rhi::Compare::greater_equal:
            return GL_GEQUAL;
        case rhi::Compare::always:
            return GL_ALWAYS;
    }
    return GL_NONE;
}

GLenum gl_blend_factor(rhi::BlendFactor factor) {
    switch (factor) {
        case rhi::BlendFactor::zero:
            return GL_ZERO;
        case rhi::BlendFactor::one:
            return GL_ONE;
        case rhi::BlendFactor::source_alpha:
            return GL_SRC_ALPHA;
        case rhi::BlendFactor::one_minus_source_alpha:
            return GL_ONE_MINUS_SRC_ALPHA;
        case rhi::BlendFactor::destination_alpha:
            return GL_DST_ALPHA;
        case rhi::BlendFactor::one_minus_destination_alpha:
            return GL_ONE_MINUS_DST_ALPHA;
        case rhi::BlendFactor::source_color:
            return GL_SRC_COLOR;
        case rhi::BlendFactor::destination_color:
            return GL_DST_COLOR;
    }
    return GL_NONE;
}

GLenum gl_blend_op(rhi::BlendOp op) {
    switch (op) {
        case rhi::BlendOp::add:
            return GL_FUNC_ADD;
        case rhi::BlendOp::subtract:
            return GL_FUNC_SUBTRACT;
        case rhi::BlendOp::minimum:
            return GL_MIN;
        case rhi::BlendOp::maximum:
            return GL_MAX;
    }
    return GL_NONE;
}

}  // namespace lumo::backends::gl
