// What is bound in the context, so that consecutive commands change only what differs.
#pragma once

#include <array>
#include <cstddef>
#include <epoxy/gl.h>
#include <optional>

#include "rhi/work.hpp"

namespace lumo::backends::gl {

struct ImageBinding {
    GLuint texture = 0;
    GLint mip = 0;
    GLenum access = GL_READ_ONLY;
    GLenum format = GL_R8;

    bool operator==(const ImageBinding&) const = default;
};

struct BufferRange {
    GLuint buffer = 0;
    GLintptr offset = 0;
    GLsizeiptr size = 0;

    bool operator==(const BufferRange&) const = default;
};

/// Each function makes a binding unless it is known to be there.
class BoundState {
  public:
    /// Nothing is known any more: objects were deleted, or others used the context.
    void forget();

    void program(GLuint name);
    void framebuffer(GLuint name);
    void texture(GLuint unit, GLuint name, GLuint sampler);
    void image(GLuint unit, const ImageBinding& image);
    void storage(GLuint slot, const BufferRange& range);
    void uniform(GLuint slot, const BufferRange& range);
    /// `target`: indirect draws and dispatches, packing and unpacking of pixels.
    void buffer(GLenum target, GLuint name);
    void raster(const rhi::RasterState& state);
    /// Clears and blits obey masks and the scissor: opens them all.
    void open_masks();
    /// Lower left corner and size; clips to it too.
    void viewport(const rhi::Viewport& viewport);

  private:
    static constexpr size_t slots = rhi::max_bindings + 1;  // of each kind; one more for push constants
    struct TextureBinding {
        GLuint texture;
        GLuint sampler;
        bool operator==(const TextureBinding&) const = default;
    };
    template <class T>
    using Known = std::optional<T>;

    Known<GLuint> program_, framebuffer_;
    Known<GLuint> draw_indirect_, dispatch_indirect_, pack_, unpack_;
    std::array<Known<TextureBinding>, slots> textures_;
    std::array<Known<ImageBinding>, slots> images_;
    std::array<Known<BufferRange>, slots> storage_, uniforms_;
    Known<rhi::RasterState> raster_;
    Known<bool> masks_open_, scissor_;
};

}  // namespace lumo::backends::gl
