// Carries out what the core of the RHI hands on.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <variant>

#include "backends/gl/adopt.hpp"
#include "backends/gl/context.hpp"
#include "backends/gl/formats.hpp"
#include "backends/gl/gl.hpp"
#include "backends/gl/programs.hpp"
#include "backends/gl/push_ring.hpp"
#include "backends/gl/resources.hpp"
#include "backends/gl/state.hpp"
#include "backends/gl/timeline.hpp"

namespace lumo::backends::gl {
namespace {

using rhi::Access;

struct Pipeline {
    struct Binding {
        GLuint slot;
        GLenum access;  ///< images
    };
    GLuint program = 0;
    std::vector<Binding> bindings{};
    rhi::RasterState raster{};
};

GLenum gl_access(rhi::ShaderAccess access) {
    if (access == rhi::ShaderAccess::read) return GL_READ_ONLY;
    return access == rhi::ShaderAccess::write ? GL_WRITE_ONLY : GL_READ_WRITE;
}

GLenum gl_topology(rhi::Topology topology) {
    static constexpr GLenum topologies[] = {GL_TRIANGLES, GL_TRIANGLE_STRIP, GL_LINES, GL_POINTS};
    return topologies[size_t(topology)];
}

GLenum gl_index_type(rhi::IndexType type) {
    return type == rhi::IndexType::uint16 ? GL_UNSIGNED_SHORT : GL_UNSIGNED_INT;
}

const void* as_pointer(uint64_t offset) { return reinterpret_cast<const void*>(offset); }

/// OpenGL orders everything by itself but what shaders write to images and storage buffers: what comes after
/// such a write, and a write that comes after anything. Coherent mappings need no bit.
GLbitfield barrier_bits(const rhi::Barrier& barrier) {
    const bool texture = barrier.memory.kind == rhi::MemoryId::Kind::texture;
    const bool after_write = rhi::has(barrier.before, Access::storage_write);
    const bool before_write =
        rhi::has(barrier.after, Access::storage_write) && barrier.before != Access::none;
    if (!after_write && !before_write) return 0;

    GLbitfield bits = 0;
    auto add = [&](Access access, GLbitfield bit) {
        if (rhi::has(barrier.after, access)) bits |= bit;
    };
    add(Access::indirect_read, GL_COMMAND_BARRIER_BIT);
    add(Access::index_read, GL_ELEMENT_ARRAY_BARRIER_BIT);
    add(Access::uniform_read, GL_UNIFORM_BARRIER_BIT);
    add(Access::sampled_read, GL_TEXTURE_FETCH_BARRIER_BIT);
    add(Access::storage_read | Access::storage_write,
        texture ? GL_SHADER_IMAGE_ACCESS_BARRIER_BIT : GL_SHADER_STORAGE_BARRIER_BIT);
    add(Access::color_attachment | Access::depth_attachment, GL_FRAMEBUFFER_BARRIER_BIT);
    // A copy of a texture may be a transfer, a blit or a fetch.
    add(Access::copy_read | Access::copy_write,
        texture ? GL_TEXTURE_UPDATE_BARRIER_BIT | GL_FRAMEBUFFER_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT
                : GL_BUFFER_UPDATE_BARRIER_BIT | GL_PIXEL_BUFFER_BARRIER_BIT);
    add(Access::host_read, GL_CLIENT_MAPPED_BUFFER_BARRIER_BIT);
    return bits;
}

float encode_srgb(float linear) {
    return linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1 / 2.4f) - 0.055f;
}

/// A clear value as texels of a transfer format.
struct ClearTexel {
    GLenum transfer;
    GLenum type;
    const void* data;
};

ClearTexel clear_texel(rhi::FormatKind kind, const rhi::ClearValue& value) {
    const void* data = std::visit([](const auto& v) { return static_cast<const void*>(v.data()); }, value);
    switch (kind) {
        case rhi::FormatKind::uint:
            return {GL_RGBA_INTEGER, GL_UNSIGNED_INT, data};
        case rhi::FormatKind::sint:
            return {GL_RGBA_INTEGER, GL_INT, data};
        case rhi::FormatKind::depth:
            return {GL_DEPTH_COMPONENT, GL_FLOAT, data};
        default:
            return {GL_RGBA, GL_FLOAT, data};
    }
}

class GlBackend final : public rhi::Backend {
  public:
    GlBackend(std::unique_ptr<Context> context, PushRing ring, bool disk_cache)
        : context_(std::move(context)),
          state_(context_->is_hosts()),
          ring_(std::move(ring)),
          timeline_(context_->info().timing),
          cache_(disk_cache ? rhi::DiskCache::of_user() : rhi::DiskCache({})) {
        glCreateVertexArrays(1, &vertex_array_);
        for (int i = 0; i < rhi::format_count; ++i) caps_[size_t(i)] = query_caps(rhi::Format(i));
    }

    ~GlBackend() override;
    GlBackend(const GlBackend&) = delete;
    GlBackend& operator=(const GlBackend&) = delete;

    const rhi::DeviceInfo& info() const override { return context_->info(); }
    rhi::FormatCaps format_caps(rhi::Format format) const override { return caps_[size_t(format)]; }

    Result<rhi::CreatedBuffer> create_buffer(rhi::BufferHandle handle, const rhi::BufferDesc& desc) override {
        return enter().and_then([&] { return resources_.create(handle, desc); });
    }
    Result<uint64_t> create_texture(rhi::TextureHandle handle, const rhi::TextureDesc& desc) override {
        return enter().and_then([&] { return resources_.create(handle, desc); });
    }
    Result<void> adopt_texture(rhi::TextureHandle handle, const rhi::TextureDesc& desc,
                               const rhi::NativeTexture& native) override {
        if (!context_->is_hosts()) return rhi::not_adopted(desc.name);
        return enter().and_then([&] { return resources_.adopt(handle, desc, native); });
    }
    Result<void> adopt_buffer(rhi::BufferHandle handle, const rhi::BufferDesc& desc,
                              const rhi::NativeBuffer& native) override {
        if (!context_->is_hosts()) return rhi::not_adopted(desc.name);
        return enter().and_then([&] { return resources_.adopt(handle, desc, native); });
    }
    Result<void> create_sampler(rhi::SamplerHandle handle, const rhi::SamplerDesc& desc) override {
        return enter().and_then([&] { return resources_.create(handle, desc); });
    }
    Result<void> create_pipeline(rhi::PipelineHandle handle, const rhi::ProgramInfo& program,
                                 std::span<const uint32_t> options, const rhi::RasterState* raster) override;

    void destroy(rhi::BufferHandle handle) override {
        if (enter_to_destroy()) resources_.destroy(handle);
    }
    void destroy(rhi::TextureHandle handle) override {
        if (enter_to_destroy()) resources_.destroy(handle);
    }
    void destroy(rhi::SamplerHandle handle) override {
        if (enter_to_destroy()) resources_.destroy(handle);
    }
    void destroy(rhi::PipelineHandle handle) override {
        if (enter_to_destroy()) glDeleteProgram(std::exchange(pipelines_[handle.index], {}).program);
    }

    Result<void> begin(uint64_t serial) override;
    Result<void> wait_for(const rhi::NativeSync& sync) override;
    Result<void> signal(const rhi::NativeSync&) override {
        return fail(ErrorKind::unsupported, "signal", "OpenGL makes a fence by the call that signals it",
                    "call glFenceSync after Device::submit");
    }
    Result<void> emit(const rhi::EmittedPass& pass) override;
    Result<void> submit(std::span<const rhi::Barrier> hand_back) override;
    uint64_t completed() override { return enter() ? timeline_.completed() : 0; }
    Result<void> wait(uint64_t serial) override {
        return enter().and_then([&] { return timeline_.wait(serial); });
    }
    std::vector<rhi::PassStamp> stamps(uint64_t serial) override;
    rhi::MemoryBudget memory_budget() override;

  private:
    /// To be called before any of OpenGL.
    Result<void> enter() {
        auto entered = context_->enter();
        if (entered && !timeline_.recording()) context_->drop_hosts_errors();
        return entered;
    }
    /// False where the host's context is not current: the object is left to the context's end.
    bool enter_to_destroy() {
        state_.forget_objects();
        indices_ = 0;
        return enter().has_value();
    }
    /// Between submissions a host's context is as the host wants it.
    void end_turn() {
        if (!context_->is_hosts()) return;
        state_.give_back();
        context_->stop_listening();
    }

    /// False where something could not be made for the pass that is emitted; the first such error is its own.
    template <class T>
    bool is_made(const Result<T>& made) {
        if (!made && refused_) refused_ = tl::unexpected(made.error());
        return made.has_value();
    }

    bool begin_targets(const rhi::RasterTargets& targets);
    void end_targets(const rhi::RasterTargets& targets);
    void blit(const Attachment& from, const rhi::Extent& from_extent, const Attachment& to,
              const rhi::Extent& to_extent, GLenum filter);
    void put_barriers(std::span<const rhi::Barrier> barriers);
    /// Null where the command is to be left out.
    const Pipeline* bind(const rhi::PipelineBindings& what);
    const Pipeline* bind_for_draw(const rhi::PipelineBindings& what);
    void bind_indices(GLuint buffer);

    void run(const rhi::DispatchCommand& command);
    void run(const rhi::DispatchIndirectCommand& command);
    void run(const rhi::DrawCommand& command);
    void run(const rhi::DrawIndexedCommand& command);
    void run(const rhi::DrawIndirectCommand& command);
    void run(const rhi::ViewportCommand& command) { state_.viewport(command.viewport); }
    void run(const rhi::CopyBufferCommand& command);
    void run(const rhi::CopyTextureCommand& command);
    void run(const rhi::CopyBufferToTextureCommand& command);
    void run(const rhi::CopyTextureToBufferCommand& command);
    void run(const rhi::FillBufferCommand& command);
    void run(const rhi::ClearTextureCommand& command);
    void run(const rhi::BlitMipCommand& command);
    void run(const rhi::PresentCommand& command);

    std::unique_ptr<Context> context_;
    Resources resources_;
    BoundState state_;
    PushRing ring_;
    Timeline timeline_;
    rhi::DiskCache cache_;
    std::vector<Pipeline> pipelines_;
    std::array<rhi::FormatCaps, rhi::format_count> caps_{};
    GLuint vertex_array_ = 0;
    GLuint indices_ = 0;              ///< bound to the vertex array
    Result<void> refused_;            ///< of the pass that is emitted
    std::optional<bool> presenting_;  ///< with vsync or without; none: the submission shows nothing
};

GlBackend::~GlBackend() {
    // The end of an own context ends what it holds.
    if (!context_->is_hosts() || !enter()) return;
    resources_.clear();
    ring_.clear();
    timeline_.clear();
    glDeleteVertexArrays(1, &vertex_array_);
}

Result<void> GlBackend::begin(uint64_t serial) {
    if (auto entered = enter(); !entered) return entered;
    if (auto begun = timeline_.begin(serial); !begun || !context_->is_hosts()) return begun;
    context_->listen();
    glMemoryBarrier(GL_ALL_BARRIER_BITS);  // what the host's shaders stored
    return {};
}

Result<void> GlBackend::wait_for(const rhi::NativeSync& sync) {
    if (!context_->is_hosts()) return rhi::not_adopted("wait");
    GLsync fence = reinterpret_cast<GLsync>(sync.object);
    if (!glIsSync(fence)) return fail(ErrorKind::invalid_argument, "wait", "it is not the name of a GLsync");
    glWaitSync(fence, 0, GL_TIMEOUT_IGNORED);
    return {};
}

Result<void> GlBackend::submit(std::span<const rhi::Barrier> hand_back) {
    if (auto entered = enter(); !entered) return entered;
    // What lumo's shaders stored, for whatever the host does with it.
    if (!hand_back.empty()) glMemoryBarrier(GL_ALL_BARRIER_BITS);
    end_turn();
    return timeline_.submit().and_then([this]() -> Result<void> {
        const auto vsync = std::exchange(presenting_, {});
        return vsync ? context_->swap(*vsync) : Result<void>{};
    });
}

std::vector<rhi::PassStamp> GlBackend::stamps(uint64_t serial) {
    if (!enter()) return {};
    state_.no_query_buffer();
    std::vector<rhi::PassStamp> stamps = timeline_.stamps(serial);
    if (!timeline_.recording()) end_turn();
    return stamps;
}

Result<void> GlBackend::create_pipeline(rhi::PipelineHandle handle, const rhi::ProgramInfo& program,
                                        std::span<const uint32_t> options, const rhi::RasterState* raster) {
    if (auto entered = enter(); !entered) return entered;
    auto made = make_program(program, options, info(), cache_);
    if (!made) return tl::unexpected(made.error());
    label(GL_PROGRAM, *made, program.name);
    Pipeline& pipeline = slot(pipelines_, handle.index);
    pipeline = {.program = *made};
    for (const rhi::BindingInfo& binding : program.bindings) {
        pipeline.bindings.push_back({binding.gl_slot, gl_access(binding.access)});
    }
    if (raster) pipeline.raster = *raster;
    return {};
}

Result<void> GlBackend::emit(const rhi::EmittedPass& pass) {
    if (auto entered = enter(); !entered) return entered;
    glPushDebugGroup(GL_DEBUG_SOURCE_APPLICATION, 0, GLsizei(pass.name.size()), pass.name.data());
    timeline_.begin_pass();
    put_barriers(pass.barriers);
    refused_ = {};
    if (!pass.targets || begin_targets(*pass.targets)) {
        for (const rhi::Step& step : pass.steps) {
            put_barriers(step.barriers);
            std::visit([this](const auto& command) { run(command); }, step.command);
        }
        if (pass.targets) end_targets(*pass.targets);
    }
    timeline_.end_pass();
    glPopDebugGroup();
    const Result<void> driver = check_errors(pass.name);
    return refused_ ? driver : refused_;
}

void GlBackend::put_barriers(std::span<const rhi::Barrier> barriers) {
    GLbitfield bits = 0;
    for (const rhi::Barrier& barrier : barriers) bits |= barrier_bits(barrier);
    if (bits) glMemoryBarrier(bits);
}

// -- raster passes

bool GlBackend::begin_targets(const rhi::RasterTargets& targets) {
    std::vector<Attachment> color;
    for (const rhi::ColorTarget& target : targets.color) {
        const auto attachment = resources_.attachment(target.view);
        if (!is_made(attachment)) return false;
        color.push_back(*attachment);
    }
    Result<Attachment> depth;
    if (targets.depth) depth = resources_.attachment(targets.depth->view);
    if (!is_made(depth)) return false;
    const auto made =
        resources_.framebuffer(color, targets.depth ? &*depth : nullptr, targets.extent, targets.samples);
    if (!is_made(made)) return false;
    const GLuint framebuffer = *made;
    state_.framebuffer(framebuffer);
    state_.open_masks();

    std::vector<GLenum> discarded;
    for (size_t i = 0; i < targets.color.size(); ++i) {
        const rhi::ColorTarget& target = targets.color[i];
        if (target.load == rhi::Load::discard) discarded.push_back(GLenum(GL_COLOR_ATTACHMENT0 + i));
        if (target.load != rhi::Load::clear) continue;
        if (const auto* value = std::get_if<std::array<float, 4>>(&target.clear)) {
            glClearNamedFramebufferfv(framebuffer, GL_COLOR, GLint(i), value->data());
        } else if (const auto* value = std::get_if<std::array<uint32_t, 4>>(&target.clear)) {
            glClearNamedFramebufferuiv(framebuffer, GL_COLOR, GLint(i), value->data());
        } else if (const auto* value = std::get_if<std::array<int32_t, 4>>(&target.clear)) {
            glClearNamedFramebufferiv(framebuffer, GL_COLOR, GLint(i), value->data());
        }
    }
    if (targets.depth && targets.depth->load == rhi::Load::discard) discarded.push_back(GL_DEPTH_ATTACHMENT);
    if (targets.depth && targets.depth->load == rhi::Load::clear) {
        glClearNamedFramebufferfv(framebuffer, GL_DEPTH, 0, &targets.depth->clear);
    }
    if (!discarded.empty()) {
        glInvalidateNamedFramebufferData(framebuffer, GLsizei(discarded.size()), discarded.data());
    }

    state_.viewport({0, 0, float(targets.extent.width), float(targets.extent.height)});
    return true;
}

void GlBackend::end_targets(const rhi::RasterTargets& targets) {
    for (const rhi::ColorTarget& target : targets.color) {
        if (!target.resolve) continue;
        const auto from = resources_.attachment(target.view), to = resources_.attachment(*target.resolve);
        if (!is_made(from) || !is_made(to)) continue;
        const rhi::Extent& extent = targets.extent;
        blit(*from, extent, *to, extent, GL_NEAREST);
    }
}

void GlBackend::blit(const Attachment& from, const rhi::Extent& from_extent, const Attachment& to,
                     const rhi::Extent& to_extent, GLenum filter) {
    const auto source = resources_.framebuffer({&from, 1}, nullptr, {}, 1);
    const auto destination = resources_.framebuffer({&to, 1}, nullptr, {}, 1);
    if (!is_made(source) || !is_made(destination)) return;
    state_.open_masks();
    glBlitNamedFramebuffer(*source, *destination, 0, 0, GLint(from_extent.width), GLint(from_extent.height),
                           0, 0, GLint(to_extent.width), GLint(to_extent.height), GL_COLOR_BUFFER_BIT,
                           filter);
}

// -- shaders

const Pipeline* GlBackend::bind(const rhi::PipelineBindings& what) {
    const Pipeline& pipeline = pipelines_[what.pipeline.index];
    state_.program(pipeline.program);
    for (size_t i = 0; i < what.bindings.size(); ++i) {
        const rhi::BindingValue& value = what.bindings[i];
        const auto [slot, access] = pipeline.bindings[i];
        const auto range = [&] {
            return BufferRange{resources_.buffer(value.slice.buffer), GLintptr(value.slice.offset),
                               GLsizeiptr(value.slice.size)};
        };
        switch (value.kind) {
            case rhi::BindingKind::sampled: {
                const auto view = resources_.view(value.view);
                if (!is_made(view)) return nullptr;
                state_.texture(slot, value.view.dimension, *view, resources_.sampler(value.sampler));
                break;
            }
            case rhi::BindingKind::storage_image: {
                const auto view = resources_.view_of_all_mips(value.view);
                if (!is_made(view)) return nullptr;
                state_.image(slot, {.texture = *view,
                                    .mip = GLint(value.view.first_mip),
                                    .access = access,
                                    .format = gl_format(value.view.format).internal});
                break;
            }
            case rhi::BindingKind::storage_buffer:
                state_.storage(slot, range());
                break;
            case rhi::BindingKind::uniform_buffer:
                state_.uniform(slot, range());
                break;
        }
    }
    if (!what.push.empty()) state_.uniform(rhi::gl_push_slot, ring_.put(what.push));
    return &pipeline;
}

const Pipeline* GlBackend::bind_for_draw(const rhi::PipelineBindings& what) {
    const Pipeline* pipeline = bind(what);
    state_.vertex_array(vertex_array_);
    if (pipeline) state_.raster(pipeline->raster);
    return pipeline;
}

void GlBackend::bind_indices(GLuint buffer) {
    if (std::exchange(indices_, buffer) != buffer) glVertexArrayElementBuffer(vertex_array_, buffer);
}

void GlBackend::run(const rhi::DispatchCommand& command) {
    if (!bind(command.what)) return;
    glDispatchCompute(command.x, command.y, command.z);
}

void GlBackend::run(const rhi::DispatchIndirectCommand& command) {
    if (!bind(command.what)) return;
    state_.dispatch_indirect(resources_.buffer(command.arguments.buffer));
    glDispatchComputeIndirect(GLintptr(command.arguments.offset));
}

void GlBackend::run(const rhi::DrawCommand& command) {
    const Pipeline* pipeline = bind_for_draw(command.what);
    if (!pipeline) return;
    glDrawArraysInstanced(gl_topology(pipeline->raster.topology), GLint(command.first_vertex),
                          GLsizei(command.vertices), GLsizei(command.instances));
}

void GlBackend::run(const rhi::DrawIndexedCommand& command) {
    const Pipeline* pipeline = bind_for_draw(command.what);
    if (!pipeline) return;
    bind_indices(resources_.buffer(command.indices.buffer));
    const uint64_t index_bytes = command.index_type == rhi::IndexType::uint16 ? 2 : 4;
    glDrawElementsInstancedBaseVertex(gl_topology(pipeline->raster.topology), GLsizei(command.count),
                                      gl_index_type(command.index_type),
                                      as_pointer(command.indices.offset + command.first_index * index_bytes),
                                      GLsizei(command.instances), command.vertex_offset);
}

void GlBackend::run(const rhi::DrawIndirectCommand& command) {
    const Pipeline* pipeline = bind_for_draw(command.what);
    if (!pipeline) return;
    const GLenum topology = gl_topology(pipeline->raster.topology);
    state_.draw_indirect(resources_.buffer(command.arguments.buffer));
    const void* arguments = as_pointer(command.arguments.offset);
    if (!command.indices.buffer) {
        glMultiDrawArraysIndirect(topology, arguments, GLsizei(command.draws), GLsizei(command.stride));
        return;
    }
    bind_indices(resources_.buffer(command.indices.buffer));
    glMultiDrawElementsIndirect(topology, gl_index_type(command.index_type), arguments,
                                GLsizei(command.draws), GLsizei(command.stride));
}

// -- copies

void GlBackend::run(const rhi::CopyBufferCommand& command) {
    glCopyNamedBufferSubData(resources_.buffer(command.source.buffer),
                             resources_.buffer(command.destination.buffer), GLintptr(command.source.offset),
                             GLintptr(command.destination.offset), GLsizeiptr(command.source.size));
}

void GlBackend::run(const rhi::CopyTextureCommand& command) {
    const Texture& source = resources_.texture(command.source);
    const Texture& destination = resources_.texture(command.destination);
    const auto& from = command.source_region;
    const auto& to = command.destination_region;
    // This command alone counts layers in z for every dimension.
    const auto z = [](const Texture& texture, const rhi::TextureRegion& region) {
        return GLint(texture.desc.dimension == rhi::Dimension::d3 ? region.z : region.first_layer);
    };
    const uint32_t slices = source.desc.dimension == rhi::Dimension::d3 ? from.extent.depth : from.layers;
    glCopyImageSubData(source.name, gl_target(source.desc.dimension), GLint(from.mip), GLint(from.x),
                       GLint(from.y), z(source, from), destination.name,
                       gl_target(destination.desc.dimension), GLint(to.mip), GLint(to.x), GLint(to.y),
                       z(destination, to), GLsizei(from.extent.width), GLsizei(from.extent.height),
                       GLsizei(slices));
}

void GlBackend::run(const rhi::CopyBufferToTextureCommand& command) {
    const Texture& texture = resources_.texture(command.destination);
    const GlFormat& format = gl_format(texture.desc.format);
    const auto mip = GLint(command.region.mip);
    const Box box = gl_box(texture.desc.dimension, command.region);
    const void* texels = as_pointer(command.source.offset);
    const auto bytes = GLsizei(command.source.size);
    state_.unpack(resources_.buffer(command.source.buffer));

    const bool compressed = format.transfer == GL_NONE;
    const bool flat = is_2d(texture.desc.dimension);
    if (texture.desc.dimension == rhi::Dimension::d1) {
        glTextureSubImage1D(texture.name, mip, box.x, box.width, format.transfer, format.type, texels);
    } else if (flat && compressed) {
        glCompressedTextureSubImage2D(texture.name, mip, box.x, box.y, box.width, box.height, format.internal,
                                      bytes, texels);
    } else if (flat) {
        glTextureSubImage2D(texture.name, mip, box.x, box.y, box.width, box.height, format.transfer,
                            format.type, texels);
    } else if (compressed) {
        glCompressedTextureSubImage3D(texture.name, mip, box.x, box.y, box.z, box.width, box.height,
                                      box.depth, format.internal, bytes, texels);
    } else {
        glTextureSubImage3D(texture.name, mip, box.x, box.y, box.z, box.width, box.height, box.depth,
                            format.transfer, format.type, texels);
    }
}

void GlBackend::run(const rhi::CopyTextureToBufferCommand& command) {
    const Texture& texture = resources_.texture(command.source);
    const GlFormat& format = gl_format(texture.desc.format);
    const auto mip = GLint(command.region.mip);
    const Box box = gl_box(texture.desc.dimension, command.region);
    void* texels = const_cast<void*>(as_pointer(command.destination.offset));
    const auto bytes = GLsizei(std::min<uint64_t>(command.destination.size, INT32_MAX));
    state_.pack(resources_.buffer(command.destination.buffer));
    if (format.transfer == GL_NONE) {
        glGetCompressedTextureSubImage(texture.name, mip, box.x, box.y, box.z, box.width, box.height,
                                       box.depth, bytes, texels);
    } else {
        glGetTextureSubImage(texture.name, mip, box.x, box.y, box.z, box.width, box.height, box.depth,
                             format.transfer, format.type, bytes, texels);
    }
}

void GlBackend::run(const rhi::FillBufferCommand& command) {
    state_.unpack(0);  // Mesa takes the value as it would a texel
    glClearNamedBufferSubData(resources_.buffer(command.destination.buffer), GL_R32UI,
                              GLintptr(command.destination.offset), GLsizeiptr(command.destination.size),
                              GL_RED_INTEGER, GL_UNSIGNED_INT, &command.value);
}

void GlBackend::run(const rhi::ClearTextureCommand& command) {
    const rhi::TextureView& view = command.view;
    const rhi::TextureDesc& desc = resources_.texture(view.texture).desc;
    const rhi::FormatKind kind = rhi::format_info(view.format).kind;
    rhi::ClearValue value = command.value;
    if (auto* color = std::get_if<std::array<float, 4>>(&value); color && kind == rhi::FormatKind::srgb) {
        // Texels are stored as given, while a clear gives linear values.
        std::transform(color->begin(), color->begin() + 3, color->begin(), encode_srgb);
    }
    const ClearTexel texel = clear_texel(kind, value);
    const auto name = resources_.view(view);
    if (!is_made(name)) return;
    for (uint32_t mip = 0; mip < view.mips; ++mip) {
        const Box box =
            gl_box(view.dimension,
                   {.layers = view.layers, .extent = rhi::mip_extent(desc.extent, view.first_mip + mip)});
        glClearTexSubImage(*name, GLint(mip), 0, 0, 0, box.width, box.height, box.depth, texel.transfer,
                           texel.type, texel.data);
    }
}

void GlBackend::run(const rhi::BlitMipCommand& command) {
    const Texture& texture = resources_.texture(command.texture);
    const rhi::TextureDesc& desc = texture.desc;
    const auto mip = GLint(command.source_mip);
    if (desc.dimension == rhi::Dimension::d3) {
        // A blit knows no filter across slices.
        const auto two = resources_.view({.texture = command.texture,
                                          .dimension = desc.dimension,
                                          .format = desc.format,
                                          .first_mip = command.source_mip,
                                          .mips = 2,
                                          .first_layer = 0,
                                          .layers = 1});
        if (is_made(two)) glGenerateTextureMipmap(*two);
        return;
    }
    const rhi::Extent from = rhi::mip_extent(desc.extent, command.source_mip);
    const rhi::Extent to = rhi::mip_extent(desc.extent, command.source_mip + 1);
    for (uint32_t layer = 0; layer < desc.layers; ++layer) {
        const GLint which = is_layered(desc.dimension) ? GLint(layer) : Attachment::all_layers;
        const Attachment above{texture.name, mip, which}, below{texture.name, mip + 1, which};
        blit(above, from, below, to, GL_LINEAR);
    }
}

void GlBackend::run(const rhi::PresentCommand& command) {
    const rhi::Extent window = context_->surface()->size();
    if (window.width == 0 || window.height == 0) return;
    const Texture& texture = resources_.texture(command.texture);
    const rhi::Extent& from = texture.desc.extent;
    const Attachment picture{texture.name};
    const auto source = resources_.framebuffer({&picture, 1}, nullptr, {}, 1);
    if (!is_made(source)) return;
    presenting_ = command.vsync;
    state_.open_masks();
    state_.framebuffer(0);      // bound, because Mesa notices a new size of the window's buffers only then
    state_.encode_srgb(false);  // texels as they are stored, neither decoded nor encoded
    glBlitNamedFramebuffer(*source, 0, 0, 0, GLint(from.width), GLint(from.height), 0, 0, GLint(window.width),
                           GLint(window.height), GL_COLOR_BUFFER_BIT,
                           from == window ? GL_NEAREST : GL_LINEAR);
}

rhi::MemoryBudget GlBackend::memory_budget() {
    if (!enter() || !epoxy_has_gl_extension("GL_NVX_gpu_memory_info")) return {};
    GLint total_kib = 0, free_kib = 0;
    glGetIntegerv(GL_GPU_MEMORY_INFO_TOTAL_AVAILABLE_MEMORY_NVX, &total_kib);
    glGetIntegerv(GL_GPU_MEMORY_INFO_CURRENT_AVAILABLE_VIDMEM_NVX, &free_kib);
    return {.used_bytes = uint64_t(total_kib - free_kib) << 10, .budget_bytes = uint64_t(total_kib) << 10};
}

Result<std::unique_ptr<rhi::Backend>> make_backend(std::unique_ptr<Context> context, bool disk_cache) {
    auto ring = PushRing::create(context->info().limits.uniform_alignment);
    if (!ring) return tl::unexpected(ring.error());
    const std::string device = context->info().name;
    std::unique_ptr<rhi::Backend> made =
        std::make_unique<GlBackend>(std::move(context), std::move(*ring), disk_cache);
    if (auto status = check_errors(device); !status) return tl::unexpected(status.error());
    return made;
}

}  // namespace

Result<std::unique_ptr<rhi::Backend>> create_backend(const rhi::DeviceDesc& desc,
                                                     const std::shared_ptr<const Surface>& surface) {
    auto context = Context::open(desc, surface);
    if (!context) return tl::unexpected(context.error());
    return make_backend(std::move(*context), desc.disk_cache);
}

Result<rhi::Device> adopt_current_context(const rhi::DeviceDesc& desc) {
    auto context = Context::adopt(desc);
    if (!context) return tl::unexpected(context.error());
    auto backend = make_backend(std::move(*context), desc.disk_cache);
    if (!backend) return tl::unexpected(backend.error());
    return rhi::Device(std::move(*backend), desc);
}

std::vector<rhi::DeviceInfo> list_devices() { return found_devices(); }

}  // namespace lumo::backends::gl
