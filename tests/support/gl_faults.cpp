// OpenGL's entry points in epoxy's table, replaced by ones that can fail.
#include <epoxy/egl.h>
#include <epoxy/gl.h>
#include <type_traits>
#include <utility>

#include "tests/support/faults.hpp"

namespace lumo::testing_support {
namespace {

/// What the next glGetError says, where a call failed that the driver never saw.
GLenum pending_error = GL_NO_ERROR;
/// The reset is told once, as drivers do when it is over.
bool reset_told = false;

/// "Buffers" of glCreateBuffers and glDeleteBuffers.
std::string_view kind_of(std::string_view function) {
    for (std::string_view verb : {"glCreate", "glDelete", "glGen"}) {
        if (!function.starts_with(verb)) continue;
        function.remove_prefix(verb.size());
        return function.ends_with('s') ? function.substr(0, function.size() - 1) : function;
    }
    return {};
}

template <class... Arguments>
int64_t count_names(const Arguments&... arguments) {
    // (n, names) or (target, n, names): those that are not zero.
    int64_t count = 0;
    GLsizei n = 0;
    const auto look = [&](const auto& argument) {
        using T = std::decay_t<decltype(argument)>;
        if constexpr (std::is_same_v<T, GLsizei>) n = argument;
        if constexpr (std::is_same_v<T, GLuint*> || std::is_same_v<T, const GLuint*>)
            for (GLsizei i = 0; i < n; ++i) count += argument[i] != 0;
    };
    (look(arguments), ...);
    return count;
}

template <FunctionName name, auto* entry>
struct Hook {
    template <class Function>
    struct Call;
    template <class Result, class... Arguments>
    struct Call<Result (*)(Arguments...)> {
        static Result run(Arguments... arguments) {
            constexpr std::string_view function = name.view();
            constexpr bool deletes = function.starts_with("glDelete");
            if (!deletes && faults().fails(function)) {
                pending_error = GL_OUT_OF_MEMORY;
                return Result();
            }
            if constexpr (deletes) {
                int64_t count = count_names(arguments...);
                if constexpr (sizeof...(Arguments) == 1) count = ((arguments != 0) + ...);
                faults().count(kind_of(function), -count);
                real(arguments...);
            } else if constexpr (std::is_void_v<Result>) {
                real(arguments...);
                if (!kind_of(function).empty()) faults().count(kind_of(function), count_names(arguments...));
            } else {
                const Result result = real(arguments...);
                if (!kind_of(function).empty()) faults().count(kind_of(function), result != Result());
                return result;
            }
        }
    };
    using Function = std::remove_pointer_t<decltype(entry)>;
    static inline Function real = nullptr;

    static void install() {
        real = reinterpret_cast<Function>(eglGetProcAddress(name.text.data()));
        *entry = &Call<Function>::run;
    }
    static void remove() { *entry = real; }
};

// These differ from the rest in what they return.

PFNGLGETERRORPROC real_get_error = nullptr;
PFNGLGETGRAPHICSRESETSTATUSPROC real_reset_status = nullptr;
PFNGLCLIENTWAITSYNCPROC real_client_wait = nullptr;
PFNGLFENCESYNCPROC real_fence = nullptr;
PFNGLDELETESYNCPROC real_delete_sync = nullptr;

GLenum get_error() {
    if (faults().is_lost()) return GL_CONTEXT_LOST;
    const GLenum pending = std::exchange(pending_error, GL_NO_ERROR);
    return pending != GL_NO_ERROR ? pending : real_get_error();
}

GLenum reset_status() {
    if (!faults().lost("glGetGraphicsResetStatus")) {
        reset_told = false;
        return real_reset_status();
    }
    return std::exchange(reset_told, true) ? GL_NO_ERROR : GL_GUILTY_CONTEXT_RESET;
}

GLenum client_wait(GLsync sync, GLbitfield flags, GLuint64 timeout) {
    return faults().lost("glClientWaitSync") ? GL_WAIT_FAILED : real_client_wait(sync, flags, timeout);
}

GLsync fence(GLenum condition, GLbitfield flags) {
    if (faults().fails("glFenceSync")) {
        pending_error = GL_OUT_OF_MEMORY;
        return nullptr;
    }
    faults().count("Sync", 1);
    return real_fence(condition, flags);
}

void delete_sync(GLsync sync) {
    if (sync) faults().count("Sync", -1);
    real_delete_sync(sync);
}

template <class Function>
void replace(Function& entry, Function& real, const char* name, Function by) {
    real = reinterpret_cast<Function>(eglGetProcAddress(name));
    entry = by;
}

template <class Visit>
void each_hook(Visit visit) {
    visit(Hook<"glCreateBuffers", &epoxy_glCreateBuffers>());
    visit(Hook<"glNamedBufferStorage", &epoxy_glNamedBufferStorage>());
    visit(Hook<"glMapNamedBufferRange", &epoxy_glMapNamedBufferRange>());
    visit(Hook<"glDeleteBuffers", &epoxy_glDeleteBuffers>());
    visit(Hook<"glCreateTextures", &epoxy_glCreateTextures>());
    visit(Hook<"glGenTextures", &epoxy_glGenTextures>());
    visit(Hook<"glTextureView", &epoxy_glTextureView>());
    visit(Hook<"glTextureStorage1D", &epoxy_glTextureStorage1D>());
    visit(Hook<"glTextureStorage2D", &epoxy_glTextureStorage2D>());
    visit(Hook<"glTextureStorage2DMultisample", &epoxy_glTextureStorage2DMultisample>());
    visit(Hook<"glTextureStorage3D", &epoxy_glTextureStorage3D>());
    visit(Hook<"glDeleteTextures", &epoxy_glDeleteTextures>());
    visit(Hook<"glCreateSamplers", &epoxy_glCreateSamplers>());
    visit(Hook<"glDeleteSamplers", &epoxy_glDeleteSamplers>());
    visit(Hook<"glCreateFramebuffers", &epoxy_glCreateFramebuffers>());
    visit(Hook<"glNamedFramebufferTexture", &epoxy_glNamedFramebufferTexture>());
    visit(Hook<"glNamedFramebufferTextureLayer", &epoxy_glNamedFramebufferTextureLayer>());
    visit(Hook<"glDeleteFramebuffers", &epoxy_glDeleteFramebuffers>());
    visit(Hook<"glCreateVertexArrays", &epoxy_glCreateVertexArrays>());
    visit(Hook<"glDeleteVertexArrays", &epoxy_glDeleteVertexArrays>());
    visit(Hook<"glCreateQueries", &epoxy_glCreateQueries>());
    visit(Hook<"glDeleteQueries", &epoxy_glDeleteQueries>());
    visit(Hook<"glCreateShader", &epoxy_glCreateShader>());
    visit(Hook<"glShaderSource", &epoxy_glShaderSource>());
    visit(Hook<"glCompileShader", &epoxy_glCompileShader>());
    visit(Hook<"glDeleteShader", &epoxy_glDeleteShader>());
    visit(Hook<"glCreateProgram", &epoxy_glCreateProgram>());
    visit(Hook<"glLinkProgram", &epoxy_glLinkProgram>());
    visit(Hook<"glProgramBinary", &epoxy_glProgramBinary>());
    visit(Hook<"glDeleteProgram", &epoxy_glDeleteProgram>());
    visit(Hook<"glDispatchCompute", &epoxy_glDispatchCompute>());
    visit(Hook<"glDrawArraysInstanced", &epoxy_glDrawArraysInstanced>());
    visit(Hook<"glCopyNamedBufferSubData", &epoxy_glCopyNamedBufferSubData>());
    visit(Hook<"glTextureSubImage2D", &epoxy_glTextureSubImage2D>());
    visit(Hook<"glGetTextureSubImage", &epoxy_glGetTextureSubImage>());
    visit(Hook<"glBlitNamedFramebuffer", &epoxy_glBlitNamedFramebuffer>());
    visit(Hook<"glGenerateTextureMipmap", &epoxy_glGenerateTextureMipmap>());
}

}  // namespace

void install_gl_faults() {
    pending_error = GL_NO_ERROR;
    reset_told = false;
    each_hook([](auto hook) { hook.install(); });
    replace(epoxy_glGetError, real_get_error, "glGetError", &get_error);
    replace(epoxy_glGetGraphicsResetStatus, real_reset_status, "glGetGraphicsResetStatus", &reset_status);
    replace(epoxy_glClientWaitSync, real_client_wait, "glClientWaitSync", &client_wait);
    replace(epoxy_glFenceSync, real_fence, "glFenceSync", &fence);
    replace(epoxy_glDeleteSync, real_delete_sync, "glDeleteSync", &delete_sync);
}

void remove_gl_faults() {
    each_hook([](auto hook) { hook.remove(); });
    epoxy_glGetError = real_get_error;
    epoxy_glGetGraphicsResetStatus = real_reset_status;
    epoxy_glClientWaitSync = real_client_wait;
    epoxy_glFenceSync = real_fence;
    epoxy_glDeleteSync = real_delete_sync;
}

}  // namespace lumo::testing_support
