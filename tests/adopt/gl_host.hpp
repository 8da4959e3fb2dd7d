// A host's OpenGL context, made by plain EGL, and state of it that is nowhere the default.
#pragma once

#include <epoxy/gl.h>
#include <memory>
#include <string>
#include <vector>

namespace lumo::testing_support {

struct HostDesc {
    int major = 4, minor = 5;
    bool es = false;
    bool compatibility = false;
    bool debug = true;
};

/// Headless. Current when made.
class GlHost {
  public:
    /// Null where EGL has no such context. With `shared`, in its share group.
    static std::unique_ptr<GlHost> make(const HostDesc& desc = {}, const GlHost* shared = nullptr);
    ~GlHost();
    GlHost(const GlHost&) = delete;
    GlHost& operator=(const GlHost&) = delete;

    void make_current() const;
    void release() const;

  private:
    GlHost(void* display, void* context) : display_(display), context_(context) {}

    void* display_;  ///< EGLDisplay and EGLContext
    void* context_;
};

/// Sets all state of the current context, of OpenGL 4.5 core, to what it is by no default. Returns the names in a
/// dump that keep their default, because core or the driver has no other value.
std::vector<std::string> set_unusual_state();

/// "buffer 3", "texture 1", … for each object of the current context that has a name up to `last`.
std::vector<std::string> named_objects(GLuint last = 4096);

}  // namespace lumo::testing_support
