// Buffers, textures, samplers, and what is made of textures on demand: views and framebuffers.
#pragma once

#include <epoxy/gl.h>
#include <map>
#include <span>
#include <vector>

#include "backends/gl/formats.hpp"
#include "rhi/backend.hpp"

namespace lumo::backends::gl {

/// The entry of a dense table, which grows to hold it.
template <class T>
T& slot(std::vector<T>& table, uint32_t index) {
    if (index >= table.size()) table.resize(index + 1);
    return table[index];
}

struct Texture {
    struct View {
        rhi::TextureView range;
        GLuint name;
    };
    GLuint name = 0;
    rhi::TextureDesc desc;
    std::vector<View> views;  ///< but the whole, which is `name`
};

/// What a framebuffer is made of.
struct Attachment {
    static constexpr GLint all_layers = -1;
    GLuint texture = 0;
    GLint mip = 0;
    GLint layer = all_layers;
};

/// Names of OpenGL objects by the core's handles.
class Resources {
  public:
    Result<rhi::CreatedBuffer> create(rhi::BufferHandle handle, const rhi::BufferDesc& desc);
    Result<uint64_t> create(rhi::TextureHandle handle, const rhi::TextureDesc& desc);
    /// A view of the host's texture, which has parameters of its own and outlives the host's name for it.
    /// Errors: invalid_argument, where the texture is not as described.
    Result<void> adopt(rhi::TextureHandle handle, const rhi::TextureDesc& desc,
                       const rhi::NativeTexture& native);
    /// The host's buffer, which is not deleted. Errors likewise.
    Result<void> adopt(rhi::BufferHandle handle, const rhi::BufferDesc& desc,
                       const rhi::NativeBuffer& native);
    Result<void> create(rhi::SamplerHandle handle, const rhi::SamplerDesc& desc);
    void destroy(rhi::BufferHandle handle);
    void destroy(rhi::TextureHandle handle);
    void destroy(rhi::SamplerHandle handle);
    /// Deletes what belongs to no handle: all others are destroyed already.
    void clear();

    GLuint buffer(rhi::BufferHandle handle) const { return buffers_[handle.index].name; }
    GLuint sampler(rhi::SamplerHandle handle) const { return samplers_[handle.index]; }
    const Texture& texture(rhi::TextureHandle handle) const { return textures_[handle.index]; }

    // What follows is made where it is not there yet. Error: out_of_memory.

    /// A texture object that shows exactly this part.
    Result<GLuint> view(const rhi::TextureView& view);
    /// The same with every mip, for commands that name the mip themselves.
    Result<GLuint> view_of_all_mips(rhi::TextureView view);

    Result<Attachment> attachment(const rhi::TextureView& view);
    /// Without any attachment the framebuffer has the given size and samples.
    Result<GLuint> framebuffer(std::span<const Attachment> color, const Attachment* depth,
                               const rhi::Extent& extent, uint32_t samples);

  private:
    struct Buffer {
        GLuint name = 0;
        bool is_hosts = false;
    };
    std::vector<Buffer> buffers_;
    std::vector<GLuint> samplers_;
    std::vector<Texture> textures_;
    std::map<std::vector<GLint>, GLuint>
        framebuffers_;  ///< by attachments, three numbers each, then the size
};

/// While it lives the driver is silent: what fails then becomes an error value, and need not be said twice.
class Silence {
  public:
    Silence();
    Silence(const Silence&) = delete;
    Silence& operator=(const Silence&) = delete;
    ~Silence();

  private:
    bool spoke_;
};

/// Labels for debuggers and messages.
void label(GLenum kind, GLuint name, std::string_view text);

/// The error about `subject` where the driver has no memory for it.
tl::unexpected<Error> out_of_memory(std::string_view subject);
/// The error of a context that was reset.
tl::unexpected<Error> context_lost();

/// Turns what glGetError holds into an error about `subject`.
Result<void> check_errors(std::string_view subject);

}  // namespace lumo::backends::gl
