// OpenGL's names for formats and shapes of textures.
#pragma once

#include <epoxy/gl.h>

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

/// Has texels in x and y alone, as texture commands take them.
constexpr bool is_2d(rhi::Dimension dimension) {
    return dimension == rhi::Dimension::d2 || dimension == rhi::Dimension::d1_array;
}

/// A region as texture commands take it: layers count in y of 1D arrays, else in z.
struct Box {
    GLint x, y, z;
    GLsizei width, height, depth;
};
Box gl_box(rhi::Dimension dimension, const rhi::TextureRegion& region);

}  // namespace lumo::backends::gl
