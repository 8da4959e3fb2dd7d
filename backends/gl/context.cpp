#include "backends/gl/context.hpp"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <algorithm>
#include <array>
#include <cctype>
#include <cstdio>
#include <dlfcn.h>
#include <fmt/format.h>
#include <string>
#include <string_view>

#include "backends/gl/state.hpp"

namespace lumo::backends::gl {
namespace {

constexpr int needed_version = 45;
constexpr std::array debug_capabilities{GLenum(GL_DEBUG_OUTPUT), GLenum(GL_DEBUG_OUTPUT_SYNCHRONOUS)};

/// EGL and OpenGL list extensions as words between spaces.
bool has_word(const char* list, std::string_view word) {
    std::string_view rest = list ? list : "";
    while (!rest.empty()) {
        const size_t end = std::min(rest.find(' '), rest.size());
        if (rest.substr(0, end) == word) return true;
        rest.remove_prefix(std::min(end + 1, rest.size()));
    }
    return false;
}

std::string lower(std::string_view text) {
    std::string out(text);
    std::ranges::transform(out, out.begin(), [](unsigned char c) { return char(std::tolower(c)); });
    return out;
}

template <class Function>
Function egl_function(const char* name) {
    return reinterpret_cast<Function>(eglGetProcAddress(name));
}

/// Displays that need no window system. The surfaceless platform picks a device by itself.
struct HeadlessDisplays {
    std::vector<EGLDisplay> devices;
    EGLDisplay surfaceless = EGL_NO_DISPLAY;
};

HeadlessDisplays headless_displays() {
    HeadlessDisplays displays;
    const char* extensions = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    const auto query_devices = egl_function<PFNEGLQUERYDEVICESEXTPROC>("eglQueryDevicesEXT");
    const auto get_display = egl_function<PFNEGLGETPLATFORMDISPLAYEXTPROC>("eglGetPlatformDisplayEXT");
    if (!get_display) return displays;

    std::array<EGLDeviceEXT, 64> devices;
    EGLint count = 0;
    if (query_devices && has_word(extensions, "EGL_EXT_platform_device") &&
        query_devices(EGLint(devices.size()), devices.data(), &count)) {
        for (EGLint i = 0; i < count; ++i) {
            displays.devices.push_back(get_display(EGL_PLATFORM_DEVICE_EXT, devices[size_t(i)], nullptr));
        }
    }
    if (has_word(extensions, "EGL_MESA_platform_surfaceless")) {
        displays.surfaceless = get_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
    }
    return displays;
}

/// A display is initialised and never terminated: it belongs to the process, and terminating it would take
/// away the contexts of everyone else who uses it.
std::unique_ptr<Context> open_on(EGLDisplay display, bool debug,
                                 std::shared_ptr<const Surface> surface = {}) {
    if (display == EGL_NO_DISPLAY) return nullptr;
    if (!eglInitialize(display, nullptr, nullptr) || !eglBindAPI(EGL_OPENGL_API)) return nullptr;
    const char* extensions = eglQueryString(display, EGL_EXTENSIONS);
    if (!has_word(extensions, "EGL_KHR_no_config_context") ||
        !has_word(extensions, "EGL_KHR_surfaceless_context")) {
        return nullptr;
    }
    const EGLint strategies[] = {EGL_LOSE_CONTEXT_ON_RESET, EGL_NO_RESET_NOTIFICATION};
    for (EGLint strategy : strategies) {
        const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                                     needed_version / 10,
                                     EGL_CONTEXT_MINOR_VERSION,
                                     needed_version % 10,
                                     EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                     EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                     EGL_CONTEXT_OPENGL_DEBUG,
                                     debug ? EGL_TRUE : EGL_FALSE,
                                     EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY,
                                     strategy,
                                     EGL_NONE};
        EGLContext made = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
        if (made == EGL_NO_CONTEXT) continue;
        // From a context of this version on, epoxy finds every function that is called.
        EGLSurface target = surface ? surface->egl_surface : EGL_NO_SURFACE;
        if (eglMakeCurrent(display, target, target, made) && epoxy_gl_version() >= needed_version) {
            return std::make_unique<Context>(display, made, std::move(surface));
        }
        eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        eglDestroyContext(display, made);
    }
    return nullptr;
}

/// glXGetCurrentContext where the process has GLX, and a context of GLX's is current; or EGL's.
CurrentContext current_context() {
    if (eglGetCurrentContext() != EGL_NO_CONTEXT) return eglGetCurrentContext;
    for (const char* library : {"libGLX.so.0", "libGL.so.1"}) {
        void* loaded = dlopen(library, RTLD_LAZY | RTLD_NOLOAD);
        if (!loaded) continue;
        const auto glx = reinterpret_cast<CurrentContext>(dlsym(loaded, "glXGetCurrentContext"));
        dlclose(loaded);  // it stays, as its host holds it
        if (glx && glx()) return glx;
    }
    return nullptr;
}

std::string gl_string(GLenum name) {
    const auto* text = reinterpret_cast<const char*>(glGetString(name));
    return text ? text : "";
}

template <class T = uint32_t>
T limit(GLenum name) {
    GLint64 value = 0;
    glGetInteger64v(name, &value);
    return T(std::max<GLint64>(value, 0));
}

rhi::Limits query_limits() {
    rhi::Limits limits;
    for (GLuint axis = 0; axis < 3; ++axis) {
        GLint groups = 0, size = 0;
        glGetIntegeri_v(GL_MAX_COMPUTE_WORK_GROUP_COUNT, axis, &groups);
        glGetIntegeri_v(GL_MAX_COMPUTE_WORK_GROUP_SIZE, axis, &size);
        limits.max_groups[axis] = uint32_t(groups);
        limits.max_group_size[axis] = uint32_t(size);
    }
    limits.max_group_invocations = limit(GL_MAX_COMPUTE_WORK_GROUP_INVOCATIONS);
    limits.max_shared_memory = limit(GL_MAX_COMPUTE_SHARED_MEMORY_SIZE);
    limits.max_texture_side_2d = limit(GL_MAX_TEXTURE_SIZE);
    limits.max_texture_side_3d = limit(GL_MAX_3D_TEXTURE_SIZE);
    limits.max_texture_layers = limit(GL_MAX_ARRAY_TEXTURE_LAYERS);
    limits.max_storage_bytes = limit<uint64_t>(GL_MAX_SHADER_STORAGE_BLOCK_SIZE);
    limits.max_uniform_bytes = limit<uint64_t>(GL_MAX_UNIFORM_BLOCK_SIZE);
    limits.storage_alignment = limit(GL_SHADER_STORAGE_BUFFER_OFFSET_ALIGNMENT);
    limits.uniform_alignment = limit(GL_UNIFORM_BUFFER_OFFSET_ALIGNMENT);
    limits.max_color_targets =
        std::min({limit(GL_MAX_COLOR_ATTACHMENTS), limit(GL_MAX_DRAW_BUFFERS), max_color_targets});
    limits.max_samples = std::min(limit(GL_MAX_COLOR_TEXTURE_SAMPLES), limit(GL_MAX_DEPTH_TEXTURE_SAMPLES));
    if (epoxy_has_gl_extension("GL_EXT_texture_filter_anisotropic")) {
        glGetFloatv(GL_MAX_TEXTURE_MAX_ANISOTROPY_EXT, &limits.max_anisotropy);
    }
    return limits;
}

rhi::DeviceInfo query_info() {
    rhi::DeviceInfo info;
    info.api = rhi::Api::gl;
    info.name = gl_string(GL_RENDERER);
    info.driver = fmt::format("{} {}", gl_string(GL_VENDOR), gl_string(GL_VERSION));
    info.api_version = fmt::format("OpenGL {}.{}", limit(GL_MAJOR_VERSION), limit(GL_MINOR_VERSION));
    const std::string name = lower(info.name);
    for (const char* renderer : {"llvmpipe", "softpipe", "swrast", "swr ", "swiftshader"}) {
        if (name.find(renderer) != std::string::npos) info.software = true;
    }
    info.geometry_shader = true;
    info.limits = query_limits();
    return info;
}

rhi::Severity severity_of(GLenum type, GLenum severity) {
    if (type == GL_DEBUG_TYPE_ERROR) return rhi::Severity::error;
    if (type == GL_DEBUG_TYPE_UNDEFINED_BEHAVIOR) return rhi::Severity::undefined;
    if (type == GL_DEBUG_TYPE_DEPRECATED_BEHAVIOR) return rhi::Severity::deprecated;
    if (type == GL_DEBUG_TYPE_PORTABILITY) return rhi::Severity::portability;
    if (type == GL_DEBUG_TYPE_PERFORMANCE) return rhi::Severity::performance;
    if (severity == GL_DEBUG_SEVERITY_HIGH) return rhi::Severity::high;
    if (severity == GL_DEBUG_SEVERITY_MEDIUM) return rhi::Severity::medium;
    return severity == GL_DEBUG_SEVERITY_LOW ? rhi::Severity::low : rhi::Severity::notification;
}

void GLAPIENTRY on_message(GLenum source, GLenum type, GLuint id, GLenum severity, GLsizei length,
                           const GLchar* text, const void* sink) {
    // The backend's own labels; and a shader that does not compile is an error value, with this message in it.
    if (type == GL_DEBUG_TYPE_PUSH_GROUP || type == GL_DEBUG_TYPE_POP_GROUP || type == GL_DEBUG_TYPE_MARKER)
        return;
    if (source == GL_DEBUG_SOURCE_SHADER_COMPILER && type == GL_DEBUG_TYPE_ERROR) return;
    std::string_view what = length < 0 ? std::string_view(text) : std::string_view(text, size_t(length));
    while (!what.empty() && (what.back() == '\n' || what.back() == '\0')) what.remove_suffix(1);
    rhi::Message message{.severity = severity_of(type, severity),
                         .id = fmt::format("gl.{}.{}", source == GL_DEBUG_SOURCE_API ? "api" : "driver", id),
                         .text = std::string(what)};
    (*static_cast<const rhi::MessageSink*>(sink))(message);
}

void print_failure(const rhi::Message& message) {
    if (rhi::is_failure(message)) fmt::print(stderr, "{}: {}\n", message.id, message.text);
}

/// Calls `visit` with a context of each device in turn, until it returns true. The surfaceless display would
/// show one of them again, so it is asked only where there are none. A surface has one device.
template <class Visit>
void visit_devices(bool debug, const std::shared_ptr<const Surface>& surface, Visit visit) {
    if (surface) {
        if (auto context = open_on(surface->egl_display, debug, surface)) visit(std::move(context));
        return;
    }
    const HeadlessDisplays displays = headless_displays();
    bool found = false;
    for (EGLDisplay display : displays.devices) {
        if (auto context = open_on(display, debug)) {
            found = true;
            if (visit(std::move(context))) return;
        }
    }
    if (found) return;
    if (auto context = open_on(displays.surfaceless, debug)) visit(std::move(context));
}

}  // namespace

Context::Context(void* display, void* context, std::shared_ptr<const Surface> surface)
    : display_(display), context_(context), surface_(std::move(surface)), info_(query_info()) {
    info_.window = surface_ != nullptr;
}

Context::Context(CurrentContext hosts) : hosts_(hosts), context_(hosts()), info_(query_info()) {}

Context::~Context() {
    if (is_hosts()) return;
    // What the host may still read of mapped memory was read before its owners went; what the device still
    // writes must end before the memory goes.
    make_current();
    glFinish();
    if (eglGetCurrentContext() == context_) {
        eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    }
    eglDestroyContext(display_, context_);
}

Result<void> Context::enter() const {
    if (!is_hosts()) {
        make_current();
        return {};
    }
    if (hosts_() != context_)
        return fail(ErrorKind::invalid_argument, info_.name,
                    "the host's context is not current on this thread",
                    "make it current around all calls of its device, and of what that made");
    return {};
}

void Context::drop_hosts_errors() const {
    if (!is_hosts()) return;
    while (const GLenum error = glGetError()) {
        if (error == GL_CONTEXT_LOST) break;
        sink_({.severity = rhi::Severity::low,
               .id = "gl.host",
               .text = fmt::format("the host left error {:#x} unread", error)});
    }
}

void Context::make_current() const {
    if (eglGetCurrentContext() == context_) return;
    eglBindAPI(EGL_OPENGL_API);
    EGLSurface target = surface_ ? surface_->egl_surface : EGL_NO_SURFACE;
    eglMakeCurrent(display_, target, target, context_);
}

Result<void> Context::swap(bool vsync) {
    if (std::exchange(interval_, vsync) != vsync) eglSwapInterval(display_, vsync);
    if (eglSwapBuffers(display_, surface_->egl_surface)) return {};
    return fail(ErrorKind::device_lost, info_.name,
                fmt::format("the window takes no frame (EGL error {:#x})", eglGetError()),
                "open the window and the device anew");
}

void Context::describe(const rhi::DeviceDesc& desc) {
    info_.validation = desc.validation;
    info_.timing = desc.timing != rhi::Timing::automatic ? desc.timing
                   : info_.software                      ? rhi::Timing::serialised
                                                         : rhi::Timing::overlapped;
    sink_ = desc.sink ? desc.sink : rhi::MessageSink(print_failure);
}

void Context::listen() {
    if (!info_.validation || listening_) return;
    listening_ = true;
    for (size_t i = 0; i < debug_capabilities.size(); ++i) {
        hosts_debug_[i] = glIsEnabled(debug_capabilities[i]);
        glEnable(debug_capabilities[i]);
    }
    glDebugMessageCallback(on_message, &sink_);
}

void Context::stop_listening() {
    if (!std::exchange(listening_, false)) return;
    glDebugMessageCallback(nullptr, nullptr);
    for (size_t i = 0; i < debug_capabilities.size(); ++i)
        if (!hosts_debug_[i]) glDisable(debug_capabilities[i]);
}

Result<std::unique_ptr<Context>> Context::open(const rhi::DeviceDesc& desc,
                                               const std::shared_ptr<const Surface>& surface) {
    const std::string wanted = lower(desc.name);
    std::unique_ptr<Context> best;
    std::vector<std::string> found;
    visit_devices(desc.validation, surface, [&](std::unique_ptr<Context> context) {
        found.push_back(context->info().name);
        if (lower(context->info().name).find(wanted) == std::string::npos) return false;
        const bool final_choice = !wanted.empty() || !context->info().software;
        if (!best || final_choice) best = std::move(context);
        return final_choice;
    });
    if (!best) {
        const std::string list = found.empty() ? "none" : fmt::format("{}", fmt::join(found, "; "));
        return fail(ErrorKind::no_device, "OpenGL",
                    found.empty() ? "EGL finds no device with OpenGL 4.5 core and surfaceless contexts"
                                  : fmt::format("no device is named like \"{}\"; found: {}", desc.name, list),
                    found.empty() ? "install a driver, such as Debian's libegl-mesa0 and libgl1-mesa-dri"
                                  : "name one of those found");
    }
    best->make_current();
    best->describe(desc);
    best->listen();
    return best;
}

Result<std::unique_ptr<Context>> Context::adopt(const rhi::DeviceDesc& desc) {
    const auto refuse = [](std::string why) {
        return fail(ErrorKind::no_device, "OpenGL", std::move(why),
                    fmt::format("make an OpenGL {}.{} core context current on this thread",
                                needed_version / 10, needed_version % 10));
    };
    const CurrentContext current = current_context();
    if (!current) return refuse("neither EGL nor GLX has a current context on this thread");
    // Of what follows, all but the last is older than any context; epoxy ends the process at a function that is
    // not there.
    if (!epoxy_is_desktop_gl()) return refuse(fmt::format("the context is of {}", gl_string(GL_VERSION)));
    if (epoxy_gl_version() < needed_version)
        return refuse(fmt::format("the context is of OpenGL {}", gl_string(GL_VERSION)));
    if (!(limit(GL_CONTEXT_PROFILE_MASK) & GL_CONTEXT_CORE_PROFILE_BIT))
        return refuse("the context is of the compatibility profile");

    auto context = std::make_unique<Context>(current);
    if (lower(context->info().name).find(lower(desc.name)) == std::string::npos)
        return fail(ErrorKind::no_device, "OpenGL",
                    fmt::format("the context is of {}, not of a device named like \"{}\"",
                                context->info().name, desc.name));
    context->describe(desc);
    GLvoid* callback = nullptr;
    glGetPointerv(GL_DEBUG_CALLBACK_FUNCTION, &callback);
    // A host that listens hears of lumo's calls as well.
    context->info_.validation =
        desc.validation && !callback && (limit(GL_CONTEXT_FLAGS) & GL_CONTEXT_FLAG_DEBUG_BIT);
    return context;
}

std::vector<rhi::DeviceInfo> found_devices() {
    std::vector<rhi::DeviceInfo> devices;
    visit_devices(false, {}, [&](std::unique_ptr<Context> context) {
        devices.push_back(context->info());
        return false;
    });
    return devices;
}

}  // namespace lumo::backends::gl
