// The work of `lumo bench rhi` by OpenGL's own calls, as a program without lumo would make them: what stays
// bound is not bound again, push constants come from a mapped buffer. Only the programs, which are not
// measured, are made by the backend.
#include <algorithm>
#include <cstring>
#include <epoxy/egl.h>

#include "backends/gl/programs.hpp"
#include "rhi/disk_cache.hpp"
#include "samples/lumo/bench/rhi_work.hpp"

namespace lumo::program {
namespace {

namespace gl = backends::gl;
using shaders::bench_rhi::mark;
using shaders::bench_rhi::step;

/// A context of its own on the display of the one that is current; it is current itself from then on.
class OwnContext {
  public:
    OwnContext() : display_(eglGetCurrentDisplay()) {
        constexpr EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                                         4,
                                         EGL_CONTEXT_MINOR_VERSION,
                                         5,
                                         EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                         EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                         EGL_NONE};
        context_ = eglCreateContext(display_, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
    }
    OwnContext(const OwnContext&) = delete;
    OwnContext& operator=(const OwnContext&) = delete;
    ~OwnContext() {
        if (eglGetCurrentContext() == context_)
            eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        if (context_) eglDestroyContext(display_, context_);
    }
    bool make_current() const {
        return context_ && eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_);
    }

  private:
    EGLDisplay display_;
    EGLContext context_ = EGL_NO_CONTEXT;
};

class StraightGl final : public RhiWork {
  public:
    explicit StraightGl(const rhi::DeviceInfo& info) : info_(info) {}
    Result<void> prepare();

    Result<double> dispatches(uint32_t count) override;
    Result<double> draws(uint32_t count) override;
    Result<std::vector<std::byte>> outcome() override;
    Result<double> transfer(Transfer what) override;

  private:
    GLuint buffer(uint64_t size, const void* data) const;
    GLuint texture(uint32_t side, const void* texels) const;
    /// The next place for push constants; `calls` of them follow each other.
    template <class Push>
    void push(uint32_t call, const Push& push);
    void make_room(uint32_t calls);

    rhi::DeviceInfo info_;
    OwnContext context_;
    GLuint step_ = 0, mark_ = 0;
    GLuint pictures_[2]{}, items_[2]{};
    GLuint corners_ = 0, target_ = 0, framebuffer_ = 0, sampler_ = 0;
    GLuint pushes_ = 0;
    std::byte* mapped_ = nullptr;
    uint32_t room_ = 0;
    size_t push_stride_ = 0;
    GLuint transfer_buffer_ = 0, transfer_texture_ = 0;
    std::vector<std::byte> bytes_ = std::vector<std::byte>(transfer_bytes, std::byte{7});
};

Result<GLuint> make(const rhi::ProgramInfo& program, const rhi::DeviceInfo& info) {
    return gl::make_program(program, {}, info, rhi::DiskCache({}));
}

GLuint StraightGl::buffer(uint64_t size, const void* data) const {
    GLuint name = 0;
    glCreateBuffers(1, &name);
    glNamedBufferStorage(name, GLsizeiptr(size), data, GL_DYNAMIC_STORAGE_BIT);
    return name;
}

GLuint StraightGl::texture(uint32_t side, const void* texels) const {
    GLuint name = 0;
    glCreateTextures(GL_TEXTURE_2D, 1, &name);
    glTextureStorage2D(name, 1, GL_RGBA8, GLsizei(side), GLsizei(side));
    if (texels)
        glTextureSubImage2D(name, 0, 0, 0, GLsizei(side), GLsizei(side), GL_RGBA, GL_UNSIGNED_BYTE, texels);
    return name;
}

Result<void> StraightGl::prepare() {
    if (!context_.make_current())
        return fail(ErrorKind::no_device, info_.name, "there is no second context on its display");
    auto step_program = make(step::info(), info_);
    if (!step_program) return tl::unexpected(step_program.error());
    auto mark_program = make(mark::info(), info_);
    if (!mark_program) return tl::unexpected(mark_program.error());
    step_ = *step_program;
    mark_ = *mark_program;
    const size_t alignment = std::max<size_t>(info_.limits.uniform_alignment, 16);
    push_stride_ = (sizeof(mark::Push) + alignment - 1) / alignment * alignment;

    const std::vector<uint32_t> items = first_items();
    for (int i = 0; i < 2; ++i) {
        pictures_[i] = texture(1, texture_colors[i]);
        items_[i] = buffer(items.size() * sizeof(uint32_t), items.data());
    }
    corners_ = buffer(2 * corners_stride, corner_bytes().data());
    target_ = texture(mark_side, nullptr);
    transfer_buffer_ = buffer(transfer_bytes, nullptr);
    transfer_texture_ = texture(transfer_side, nullptr);
    glCreateFramebuffers(1, &framebuffer_);
    glNamedFramebufferTexture(framebuffer_, GL_COLOR_ATTACHMENT0, target_, 0);
    glCreateSamplers(1, &sampler_);
    glSamplerParameteri(sampler_, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glSamplerParameteri(sampler_, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    GLuint vertex_array = 0;
    glCreateVertexArrays(1, &vertex_array);
    glBindVertexArray(vertex_array);
    return glGetError() == GL_NO_ERROR
               ? Result<void>{}
               : fail(ErrorKind::out_of_memory, info_.name, "the objects of the benchmark could not be made");
}

void StraightGl::make_room(uint32_t calls) {
    context_.make_current();
    if (calls <= room_) return;
    constexpr GLbitfield mapping = GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT | GL_MAP_WRITE_BIT;
    const auto size = GLsizeiptr(calls * push_stride_);
    glDeleteBuffers(1, &pushes_);
    glCreateBuffers(1, &pushes_);
    glNamedBufferStorage(pushes_, size, nullptr, mapping);
    mapped_ = static_cast<std::byte*>(glMapNamedBufferRange(pushes_, 0, size, mapping));
    room_ = calls;
}

template <class Push>
void StraightGl::push(uint32_t call, const Push& push) {
    const size_t offset = call * push_stride_;
    std::memcpy(mapped_ + offset, &push, sizeof push);
    constexpr size_t block = (sizeof push + 15) / 16 * 16;
    glBindBufferRange(GL_UNIFORM_BUFFER, rhi::gl_push_slot, pushes_, GLintptr(offset), block);
}

/// The slot of a binding by its place in the program.
template <class P>
GLuint slot_of(size_t binding) {
    return P::info().bindings[binding].gl_slot;
}

/// CPU seconds to record and submit; then waits.
template <class Record>
double submitted(Record record) {
    const CpuTimer timer;
    record();
    GLsync fence = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
    glFlush();
    const double seconds = timer.seconds();
    glFinish();
    glDeleteSync(fence);
    return seconds;
}

Result<double> StraightGl::dispatches(uint32_t count) {
    make_room(count);
    const GLuint picture = slot_of<step>(0), source = slot_of<step>(1), target = slot_of<step>(2);
    return submitted([&] {
        glUseProgram(step_);
        glBindSampler(picture, sampler_);
        for (uint32_t i = 0; i < count; ++i) {
            const uint32_t odd = i % 2;
            glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
            glBindTextureUnit(picture, pictures_[odd]);
            glBindBufferRange(GL_SHADER_STORAGE_BUFFER, source, items_[odd], 0,
                              step_items * sizeof(uint32_t));
            glBindBufferRange(GL_SHADER_STORAGE_BUFFER, target, items_[1 - odd], 0,
                              step_items * sizeof(uint32_t));
            push(i, step_push(i));
            glDispatchCompute(1, 1, 1);
        }
    });
}

Result<double> StraightGl::draws(uint32_t count) {
    make_room(count);
    const GLuint corners = slot_of<mark>(0), picture = slot_of<mark>(1);
    return submitted([&] {
        constexpr float black[4] = {};
        glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
        glClearNamedFramebufferfv(framebuffer_, GL_COLOR, 0, black);
        glViewport(0, 0, mark_side, mark_side);
        glUseProgram(mark_);
        glBindSampler(picture, sampler_);
        for (uint32_t i = 0; i < count; ++i) {
            const uint32_t odd = i % 2;
            glBindBufferRange(GL_SHADER_STORAGE_BUFFER, corners, corners_, GLintptr(odd * corners_stride),
                              corners_stride);
            glBindTextureUnit(picture, pictures_[odd]);
            push(i, mark_push(i));
            glDrawArraysInstanced(GL_TRIANGLES, 0, 3, 1);
        }
    });
}

Result<std::vector<std::byte>> StraightGl::outcome() {
    context_.make_current();
    constexpr size_t words = step_items * sizeof(uint32_t), texels = size_t{mark_side} * mark_side * 4;
    std::vector<std::byte> bytes(words + texels);
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    glGetNamedBufferSubData(items_[0], 0, words, bytes.data());
    glGetTextureImage(target_, 0, GL_RGBA, GL_UNSIGNED_BYTE, texels, bytes.data() + words);
    return bytes;
}

Result<double> StraightGl::transfer(Transfer what) {
    context_.make_current();
    constexpr auto side = GLsizei(transfer_side);
    const double start = wall_seconds();
    switch (what) {
        case Transfer::buffer_upload:
            glNamedBufferSubData(transfer_buffer_, 0, transfer_bytes, bytes_.data());
            break;
        case Transfer::texture_upload:
            glTextureSubImage2D(transfer_texture_, 0, 0, 0, side, side, GL_RGBA, GL_UNSIGNED_BYTE,
                                bytes_.data());
            break;
        case Transfer::buffer_readback:
            glGetNamedBufferSubData(transfer_buffer_, 0, transfer_bytes, bytes_.data());
            break;
        case Transfer::texture_readback:
            glGetTextureImage(transfer_texture_, 0, GL_RGBA, GL_UNSIGNED_BYTE, transfer_bytes, bytes_.data());
            break;
    }
    glFinish();
    return wall_seconds() - start;
}

}  // namespace

Result<std::unique_ptr<RhiWork>> work_straight_to_gl(const rhi::DeviceInfo& info) {
    auto made = std::make_unique<StraightGl>(info);
    return made->prepare().map([&]() -> std::unique_ptr<RhiWork> { return std::move(made); });
}

}  // namespace lumo::program
