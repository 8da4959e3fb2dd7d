// OpenGL's names for the RHI's formats and enumerations.
#pragma once

#include <epoxy/gl.h>

#include "rhi/resources.hpp"
#include "rhi/work.hpp"

namespace lumo::backends::gl {

/// How texels are stored, and how they travel to and from buffers unconverted. Compressed formats have no
/// transfer format.
struct GlFormat {
    GLenum internal = GL_NONE;
    GLenum transfer = GL_NONE;
    GLenum type = GL_NONE;
};

const GlFormat& gl_format(rhi::Format format);
/// Asks the current context.
rhi::FormatCaps query_caps(rhi::Format format);

GLenum gl_target(rhi::Dimension dimension);
constexpr bool is_layered(rhi::Dimension dimension) {
    using enum rhi::Dimension;
    return dimension == d3 || dimension == cube || dimension == d1_array || dimension == d2_array ||
           dimension == cube_array;
}

/// A region as texture commands take it: layers count in y of 1D arrays, else in z.
struct Box {
    GLint x, y, z;
    GLsizei width, height, depth;
};
Box gl_box(rhi::Dimension dimension, const rhi::TextureRegion& region);

GLenum gl_topology(rhi::Topology topology);
GLenum gl_compare(rhi::Compare compare);
GLenum gl_blend_factor(rhi::BlendFactor factor);
GLenum gl_blend_op(rhi::BlendOp op);

}  // namespace lumo::backends::gl
