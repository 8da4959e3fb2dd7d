#include "backends/gl/resources.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <string>

#include "rhi/rhi.hpp"

namespace lumo::backends::gl {
namespace {

using rhi::Dimension;

GLint gl_filter(rhi::FilterMode filter) { return filter == rhi::FilterMode::linear ? GL_LINEAR : GL_NEAREST; }

GLint gl_filter(rhi::FilterMode filter, rhi::FilterMode mip) {
    static constexpr GLint filters[2][2] = {{GL_NEAREST_MIPMAP_NEAREST, GL_NEAREST_MIPMAP_LINEAR},
                                            {GL_LINEAR_MIPMAP_NEAREST, GL_LINEAR_MIPMAP_LINEAR}};
    return filters[size_t(filter)][size_t(mip)];
}

GLint gl_address(rhi::AddressMode mode) {
    static constexpr GLint modes[] = {GL_REPEAT, GL_MIRRORED_REPEAT, GL_CLAMP_TO_EDGE, GL_CLAMP_TO_BORDER};
    return modes[size_t(mode)];
}

/// What the texels take; OpenGL does not tell what the driver adds.
uint64_t texture_bytes(const rhi::TextureDesc& desc) {
    uint64_t bytes = 0;
    for (uint32_t mip = 0; mip < desc.mips; ++mip) bytes += region_bytes(desc.format, whole_mip(desc, mip));
    return bytes * desc.samples;
}

void allocate(GLuint name, const rhi::TextureDesc& desc) {
    const GLenum internal = gl_format(desc.format).internal;
    const auto mips = GLsizei(desc.mips), samples = GLsizei(desc.samples);
    const Box box = gl_box(desc.dimension, whole_mip(desc));
    if (desc.dimension == Dimension::d2_multisample) {
        glTextureStorage2DMultisample(name, samples, internal, box.width, box.height, GL_TRUE);
    } else if (desc.dimension == Dimension::d1) {
        glTextureStorage1D(name, mips, internal, box.width);
    } else if (is_2d(desc.dimension) || desc.dimension == Dimension::cube) {
        glTextureStorage2D(name, mips, internal, box.width, box.height);
    } else {
        glTextureStorage3D(name, mips, internal, box.width, box.height, box.depth);
    }
}

/// Why a host's texture is not what the description says; empty where it is.
std::string mismatch(GLuint name, const rhi::TextureDesc& desc) {
    if (!glIsTexture(name)) return fmt::format("{} is not the name of a texture", name);
    const auto parameter = [name](GLenum what) {
        GLint value = 0;
        glGetTextureParameteriv(name, what, &value);
        return value;
    };
    const auto of_mip_0 = [name](GLenum what) {
        GLint value = 0;
        glGetTextureLevelParameteriv(name, 0, what, &value);
        return value;
    };
    Box box = gl_box(desc.dimension, whole_mip(desc));
    if (desc.dimension == Dimension::cube) box.depth = 1;  // its faces do not count
    struct Fact {
        const char* what;
        GLint found, described;
        bool hexadecimal = false;
    };
    const Fact target{"target", parameter(GL_TEXTURE_TARGET), GLint(gl_target(desc.dimension)), true};
    const Fact facts[] = {
        {"immutable storage", parameter(GL_TEXTURE_IMMUTABLE_FORMAT), GL_TRUE},
        {"internal format", of_mip_0(GL_TEXTURE_INTERNAL_FORMAT), GLint(gl_format(desc.format).internal),
         true},
        {"width", of_mip_0(GL_TEXTURE_WIDTH), box.width},
        {"height", of_mip_0(GL_TEXTURE_HEIGHT), box.height},
        {"depth or layers", of_mip_0(GL_TEXTURE_DEPTH), box.depth},
        {"mips", parameter(GL_TEXTURE_VIEW_NUM_LEVELS), GLint(desc.mips)},
        {"samples", std::max(of_mip_0(GL_TEXTURE_SAMPLES), 1), GLint(desc.samples)},
    };
    const auto text = [](const Fact& fact) {
        return fact.hexadecimal
                   ? fmt::format("its {} is {:#x}, not {:#x}", fact.what, fact.found, fact.described)
                   : fmt::format("its {} is {}, not {}", fact.what, fact.found, fact.described);
    };
    if (target.found != target.described) return text(target);
    for (const Fact& fact : facts)
        if (fact.found != fact.described) return text(fact);
    return {};
}

void attach(GLuint framebuffer, GLenum point, const Attachment& attachment) {
    if (attachment.layer == Attachment::all_layers) {
        glNamedFramebufferTexture(framebuffer, point, attachment.texture, attachment.mip);
    } else {
        glNamedFramebufferTextureLayer(framebuffer, point, attachment.texture, attachment.mip,
                                       attachment.layer);
    }
}

}  // namespace

Silence::Silence() : spoke_(glIsEnabled(GL_DEBUG_OUTPUT)) { glDisable(GL_DEBUG_OUTPUT); }

Silence::~Silence() {
    if (spoke_) glEnable(GL_DEBUG_OUTPUT);
}

void label(GLenum kind, GLuint name, std::string_view text) {
    constexpr size_t longest = 255;  // what every driver takes
    if (!text.empty()) glObjectLabel(kind, name, GLsizei(std::min(text.size(), longest)), text.data());
}

tl::unexpected<Error> out_of_memory(std::string_view subject) {
    return fail(ErrorKind::out_of_memory, std::string(subject), "the OpenGL driver is out of memory");
}

tl::unexpected<Error> context_lost() {
    return fail(ErrorKind::device_lost, "OpenGL", "the driver reset the device", "make the device anew");
}

Result<void> check_errors(std::string_view subject) {
    const GLenum error = glGetError();
    // The first tells most, but a lost context, which may say so for ever, outdoes all.
    GLenum last = error;
    while (last != GL_NO_ERROR && last != GL_CONTEXT_LOST) last = glGetError();
    switch (last == GL_CONTEXT_LOST ? last : error) {
        case GL_NO_ERROR:
            return {};
        case GL_OUT_OF_MEMORY:
            return out_of_memory(subject);
        case GL_CONTEXT_LOST:
            return context_lost();
        default:
            return fail(ErrorKind::unsupported, std::string(subject),
                        fmt::format("the OpenGL driver refuses it with error {:#x}", error));
    }
}

Result<rhi::CreatedBuffer> Resources::create(rhi::BufferHandle handle, const rhi::BufferDesc& desc) {
    constexpr GLbitfield mapping = GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
    GLbitfield flags = 0;
    if (desc.memory == rhi::Memory::upload) flags = mapping | GL_MAP_WRITE_BIT;
    if (desc.memory == rhi::Memory::readback) flags = mapping | GL_MAP_READ_BIT;

    const Silence silence;
    GLuint name = 0;
    glCreateBuffers(1, &name);
    glNamedBufferStorage(name, GLsizeiptr(desc.size), nullptr, flags);
    rhi::CreatedBuffer created{.allocated_bytes = desc.size};
    auto status = check_errors(desc.name);
    if (status && flags) {
        created.mapped =
            static_cast<std::byte*>(glMapNamedBufferRange(name, 0, GLsizeiptr(desc.size), flags));
        if (!created.mapped) {
            (void)check_errors(desc.name);
            status = out_of_memory(desc.name);
        }
    }
    if (!status) {
        glDeleteBuffers(1, &name);
        return tl::unexpected(status.error());
    }
    label(GL_BUFFER, name, desc.name);
    slot(buffers_, handle.index) = {name};
    return created;
}

Result<uint64_t> Resources::create(rhi::TextureHandle handle, const rhi::TextureDesc& desc) {
    const Silence silence;
    GLuint name = 0;
    glCreateTextures(gl_target(desc.dimension), 1, &name);
    allocate(name, desc);
    if (auto status = check_errors(desc.name); !status) {
        glDeleteTextures(1, &name);
        return tl::unexpected(status.error());
    }
    label(GL_TEXTURE, name, desc.name);
    slot(textures_, handle.index) = {name, desc, {}};
    return texture_bytes(desc);
}

Result<void> Resources::adopt(rhi::TextureHandle handle, const rhi::TextureDesc& desc,
                              const rhi::NativeTexture& native) {
    const auto hosts = GLuint(native.object);
    if (const std::string why = mismatch(hosts, desc); !why.empty())
        return fail(ErrorKind::invalid_argument, desc.name, why,
                    "make it by glTextureStorage, and describe it as it is");
    GLuint name = 0;
    glGenTextures(1, &name);
    glTextureView(name, gl_target(desc.dimension), hosts, gl_format(desc.format).internal, 0, desc.mips, 0,
                  desc.layers);
    if (auto status = check_errors(desc.name); !status) {
        glDeleteTextures(1, &name);
        return status;
    }
    label(GL_TEXTURE, name, desc.name);
    slot(textures_, handle.index) = {name, desc, {}};
    return {};
}

Result<void> Resources::adopt(rhi::BufferHandle handle, const rhi::BufferDesc& desc,
                              const rhi::NativeBuffer& native) {
    const auto name = GLuint(native.object);
    if (!glIsBuffer(name))
        return fail(ErrorKind::invalid_argument, desc.name, fmt::format("{} is no buffer's name", name));
    GLint64 size = 0;
    glGetNamedBufferParameteri64v(name, GL_BUFFER_SIZE, &size);
    if (uint64_t(size) < desc.size)
        return fail(ErrorKind::invalid_argument, desc.name,
                    fmt::format("the host's buffer has {} bytes, {} are described", size, desc.size));
    slot(buffers_, handle.index) = {name, true};
    return {};
}

Result<void> Resources::create(rhi::SamplerHandle handle, const rhi::SamplerDesc& desc) {
    static constexpr GLfloat borders[][4] = {{0, 0, 0, 0}, {0, 0, 0, 1}, {1, 1, 1, 1}};
    const Silence silence;
    GLuint name = 0;
    glCreateSamplers(1, &name);
    glSamplerParameteri(name, GL_TEXTURE_MAG_FILTER, gl_filter(desc.magnification));
    glSamplerParameteri(name, GL_TEXTURE_MIN_FILTER, gl_filter(desc.minification, desc.mip));
    glSamplerParameteri(name, GL_TEXTURE_WRAP_S, gl_address(desc.address_u));
    glSamplerParameteri(name, GL_TEXTURE_WRAP_T, gl_address(desc.address_v));
    glSamplerParameteri(name, GL_TEXTURE_WRAP_R, gl_address(desc.address_w));
    glSamplerParameterfv(name, GL_TEXTURE_BORDER_COLOR, borders[size_t(desc.border)]);
    glSamplerParameterf(name, GL_TEXTURE_MIN_LOD, desc.min_lod);
    glSamplerParameterf(name, GL_TEXTURE_MAX_LOD, desc.max_lod);
    if (desc.max_anisotropy > 1)
        glSamplerParameterf(name, GL_TEXTURE_MAX_ANISOTROPY_EXT, desc.max_anisotropy);
    if (auto status = check_errors("sampler"); !status) {
        glDeleteSamplers(1, &name);
        return status;
    }
    slot(samplers_, handle.index) = name;
    return {};
}

void Resources::destroy(rhi::BufferHandle handle) {
    const Buffer buffer = std::exchange(buffers_[handle.index], {});
    if (!buffer.is_hosts) glDeleteBuffers(1, &buffer.name);
}

void Resources::destroy(rhi::SamplerHandle handle) { glDeleteSamplers(1, &samplers_[handle.index]); }

void Resources::destroy(rhi::TextureHandle handle) {
    Texture texture = std::exchange(textures_[handle.index], {});
    std::vector<GLuint> names{texture.name};
    for (const Texture::View& view : texture.views) names.push_back(view.name);
    std::erase_if(framebuffers_, [&](const auto& entry) {
        bool uses = false;
        for (size_t i = 0; i + 2 < entry.first.size(); i += 3) {
            uses = uses || std::ranges::find(names, GLuint(entry.first[i])) != names.end();
        }
        if (uses) glDeleteFramebuffers(1, &entry.second);
        return uses;
    });
    glDeleteTextures(GLsizei(names.size()), names.data());
}

void Resources::clear() {
    for (const auto& [key, framebuffer] : framebuffers_) glDeleteFramebuffers(1, &framebuffer);
    framebuffers_.clear();
}

Result<GLuint> Resources::view(const rhi::TextureView& view) {
    Texture& texture = textures_[view.texture.index];
    const rhi::TextureDesc& desc = texture.desc;
    if (view.dimension == desc.dimension && view.format == desc.format && view.first_mip == 0 &&
        view.mips == desc.mips && view.first_layer == 0 && view.layers == desc.layers) {
        return texture.name;
    }
    auto found = std::ranges::find(texture.views, view, &Texture::View::range);
    if (found != texture.views.end()) return found->name;

    const Silence silence;
    GLuint name = 0;
    glGenTextures(1, &name);
    glTextureView(name, gl_target(view.dimension), texture.name, gl_format(view.format).internal,
                  view.first_mip, view.mips, view.first_layer, view.layers);
    if (auto status = check_errors(desc.name); !status) {
        glDeleteTextures(1, &name);
        status.error().message = "a view of it: " + status.error().message;
        return tl::unexpected(status.error());
    }
    label(GL_TEXTURE, name, desc.name);
    texture.views.push_back({view, name});
    return name;
}

Result<GLuint> Resources::view_of_all_mips(rhi::TextureView view) {
    view.first_mip = 0;
    view.mips = texture(view.texture).desc.mips;
    return this->view(view);
}

Result<Attachment> Resources::attachment(const rhi::TextureView& view) {
    const rhi::TextureDesc& desc = texture(view.texture).desc;
    const bool whole = view.layers > 1 || !is_layered(desc.dimension);
    rhi::TextureView shown = view;
    if (!whole) {  // one layer of many: attached alone, without a view for each
        shown.dimension = desc.dimension;
        shown.first_layer = 0;
        shown.layers = desc.layers;
    }
    return view_of_all_mips(shown).map([&](GLuint name) {
        return Attachment{name, GLint(view.first_mip),
                          whole ? Attachment::all_layers : GLint(view.first_layer)};
    });
}

Result<GLuint> Resources::framebuffer(std::span<const Attachment> color, const Attachment* depth,
                                      const rhi::Extent& extent, uint32_t samples) {
    std::vector<GLint> key;
    for (const Attachment& a : color) key.insert(key.end(), {GLint(a.texture), a.mip, a.layer});
    if (depth) {
        key.insert(key.end(), {GLint(depth->texture), depth->mip, depth->layer});
        key.push_back(-1);  // two numbers short of an attachment: depth is not the last colour
    }
    if (key.empty()) key = {0, GLint(extent.width), GLint(extent.height), GLint(samples)};
    if (auto found = framebuffers_.find(key); found != framebuffers_.end()) return found->second;

    const Silence silence;
    GLuint name = 0;
    glCreateFramebuffers(1, &name);
    std::vector<GLenum> points;
    for (size_t i = 0; i < color.size(); ++i) {
        points.push_back(GLenum(GL_COLOR_ATTACHMENT0 + i));
        attach(name, points.back(), color[i]);
    }
    glNamedFramebufferDrawBuffers(name, GLsizei(points.size()), points.data());
    if (depth) attach(name, GL_DEPTH_ATTACHMENT, *depth);
    if (color.empty() && !depth) {
        glNamedFramebufferParameteri(name, GL_FRAMEBUFFER_DEFAULT_WIDTH, GLint(extent.width));
        glNamedFramebufferParameteri(name, GL_FRAMEBUFFER_DEFAULT_HEIGHT, GLint(extent.height));
        glNamedFramebufferParameteri(name, GL_FRAMEBUFFER_DEFAULT_SAMPLES, samples > 1 ? GLint(samples) : 0);
    }
    if (auto status = check_errors("framebuffer"); !status) {
        glDeleteFramebuffers(1, &name);
        return tl::unexpected(status.error());
    }
    return framebuffers_.emplace(std::move(key), name).first->second;
}

}  // namespace lumo::backends::gl
