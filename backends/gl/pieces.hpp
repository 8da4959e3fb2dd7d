// The pieces of a context's state that the backend sets: how each is read and written.
//
// A kind has a Value, read(index) and write(index, value); the index counts units, slots or targets where there
// are several of a kind.
#pragma once

#include <array>
#include <cstddef>
#include <epoxy/gl.h>
#include <optional>
#include <type_traits>
#include <vector>

namespace lumo::backends::gl {

struct ImageBinding {
    GLuint texture = 0;
    GLint mip = 0;
    GLenum access = GL_READ_ONLY;
    GLenum format = GL_R8;
    /// Layered always: OpenGL ignores it for textures without layers, and lumo's views hold just the layers wanted.
    GLboolean layered = GL_TRUE;
    GLint layer = 0;

    bool operator==(const ImageBinding&) const = default;
};

/// A size of 0 binds the whole buffer.
struct BufferRange {
    GLuint buffer = 0;
    GLintptr offset = 0;
    GLsizeiptr size = 0;

    bool operator==(const BufferRange&) const = default;
};

namespace piece {

/// What refers to objects by name. OpenGL gives names of deleted objects to new ones, so after a deletion it is not
/// known what a name that was bound means.
struct NamesObjects {};

/// What one query reads and one function sets, its other arguments given.
template <class T, GLenum query, auto& set, GLenum... arguments>
struct Single {
    using Value = T;
    static T read(GLuint) {
        if constexpr (std::is_same_v<T, GLfloat>) {
            GLfloat value = 0;
            glGetFloatv(query, &value);
            return value;
        } else {
            GLint values[2] = {};  // the polygon mode may read as two
            glGetIntegerv(query, values);
            return T(values[0]);
        }
    }
    static void write(GLuint, T value) { set(arguments..., value); }
};

template <GLenum name>
struct Enabled {
    using Value = bool;
    static bool read(GLuint) { return glIsEnabled(name); }
    static void write(GLuint, bool on) { on ? glEnable(name) : glDisable(name); }
};
template <GLenum name>
struct EnabledAt {
    using Value = bool;
    static bool read(GLuint index) { return glIsEnabledi(name, index); }
    static void write(GLuint index, bool on) { on ? glEnablei(name, index) : glDisablei(name, index); }
};

template <GLenum name>
using PixelStore = Single<GLint, name, glPixelStorei, name>;
using FrontFace = Single<GLenum, GL_FRONT_FACE, glFrontFace>;
using ProvokingVertex = Single<GLenum, GL_PROVOKING_VERTEX, glProvokingVertex>;
using CullFace = Single<GLenum, GL_CULL_FACE_MODE, glCullFace>;
using DepthFunction = Single<GLenum, GL_DEPTH_FUNC, glDepthFunc>;
using DepthMask = Single<GLboolean, GL_DEPTH_WRITEMASK, glDepthMask>;
using PolygonMode = Single<GLenum, GL_POLYGON_MODE, glPolygonMode, GL_FRONT_AND_BACK>;
using LineWidth = Single<GLfloat, GL_LINE_WIDTH, glLineWidth>;
using PointFade =
    Single<GLfloat, GL_POINT_FADE_THRESHOLD_SIZE, glPointParameterf, GL_POINT_FADE_THRESHOLD_SIZE>;
using PointOrigin =
    Single<GLint, GL_POINT_SPRITE_COORD_ORIGIN, glPointParameteri, GL_POINT_SPRITE_COORD_ORIGIN>;

struct VertexArray : Single<GLuint, GL_VERTEX_ARRAY_BINDING, glBindVertexArray>, NamesObjects {};
struct Framebuffer : Single<GLuint, GL_DRAW_FRAMEBUFFER_BINDING, glBindFramebuffer, GL_DRAW_FRAMEBUFFER>,
                     NamesObjects {};
struct Program : Single<GLuint, GL_CURRENT_PROGRAM, glUseProgram>, NamesObjects {};
using ActiveTexture = Single<GLenum, GL_ACTIVE_TEXTURE, glActiveTexture>;
template <GLenum query, GLenum target>
struct BufferBinding : Single<GLuint, query, glBindBuffer, target>, NamesObjects {};
using DrawIndirectBuffer = BufferBinding<GL_DRAW_INDIRECT_BUFFER_BINDING, GL_DRAW_INDIRECT_BUFFER>;
using DispatchIndirectBuffer =
    BufferBinding<GL_DISPATCH_INDIRECT_BUFFER_BINDING, GL_DISPATCH_INDIRECT_BUFFER>;
using PackBuffer = BufferBinding<GL_PIXEL_PACK_BUFFER_BINDING, GL_PIXEL_PACK_BUFFER>;
using UnpackBuffer = BufferBinding<GL_PIXEL_UNPACK_BUFFER_BINDING, GL_PIXEL_UNPACK_BUFFER>;
using QueryBuffer = BufferBinding<GL_QUERY_BUFFER_BINDING, GL_QUERY_BUFFER>;
using StorageBuffer = BufferBinding<GL_SHADER_STORAGE_BUFFER_BINDING, GL_SHADER_STORAGE_BUFFER>;
using UniformBuffer = BufferBinding<GL_UNIFORM_BUFFER_BINDING, GL_UNIFORM_BUFFER>;

/// Of a host's program, or pipeline of programs: glUseProgram resets them.
struct Subroutines {
    using Value = std::array<std::vector<GLuint>, 6>;  ///< by stage
    static Value read(GLuint);
    static void write(GLuint, const Value& value);
};

struct ClipControl {
    struct Value {
        GLint origin, depth;
        bool operator==(const Value&) const = default;
    };
    static Value read(GLuint);
    static void write(GLuint, Value value) { glClipControl(GLenum(value.origin), GLenum(value.depth)); }
};

struct PolygonOffset {
    struct Value {
        GLfloat factor, units, clamp;
        bool operator==(const Value&) const = default;
    };
    static Value read(GLuint);
    static void write(GLuint, Value value);
};

/// By viewport.
struct ViewportBox {
    using Value = std::array<GLfloat, 4>;
    static Value read(GLuint index);
    static void write(GLuint index, const Value& value) { glViewportIndexedfv(index, value.data()); }
};
struct ScissorBox {
    using Value = std::array<GLint, 4>;
    static Value read(GLuint index);
    static void write(GLuint index, const Value& value) { glScissorIndexedv(index, value.data()); }
};
struct DepthRange {
    using Value = std::array<GLdouble, 2>;
    static Value read(GLuint index);
    static void write(GLuint index, const Value& value) { glDepthRangeIndexed(index, value[0], value[1]); }
};

/// By colour target.
struct ColorMask {
    using Value = std::array<GLboolean, 4>;
    static Value read(GLuint target);
    static void write(GLuint target, const Value& v) { glColorMaski(target, v[0], v[1], v[2], v[3]); }
};
struct BlendFunction {
    using Value = std::array<GLenum, 4>;  ///< source and destination of colour, then of alpha
    static Value read(GLuint target);
    static void write(GLuint target, const Value& v) { glBlendFuncSeparatei(target, v[0], v[1], v[2], v[3]); }
};
struct BlendEquation {
    using Value = std::array<GLenum, 2>;  ///< of colour and alpha
    static Value read(GLuint target);
    static void write(GLuint target, const Value& v) { glBlendEquationSeparatei(target, v[0], v[1]); }
};

/// By unit; for each, a texture per target (rhi::Dimension). Reading changes the active texture, writing 0 as well.
struct TextureAt : NamesObjects {
    static constexpr GLuint targets = 8;
    using Value = GLuint;
    static GLuint read(GLuint index);
    static void write(GLuint index, GLuint name);
};
/// By unit. Reading changes the active texture.
struct SamplerAt : NamesObjects {
    using Value = GLuint;
    static GLuint read(GLuint unit);
    static void write(GLuint unit, GLuint name) { glBindSampler(unit, name); }
};
struct ImageAt : NamesObjects {
    using Value = ImageBinding;
    static ImageBinding read(GLuint unit);
    static void write(GLuint unit, const ImageBinding& image) {
        glBindImageTexture(unit, image.texture, image.mip, image.layered, image.layer, image.access,
                           image.format);
    }
};
/// By slot. Writing sets the target's own binding too.
struct StorageAt : NamesObjects {
    using Value = BufferRange;
    static BufferRange read(GLuint slot);
    static void write(GLuint slot, const BufferRange& range);
};
struct UniformAt : NamesObjects {
    using Value = BufferRange;
    static BufferRange read(GLuint slot);
    static void write(GLuint slot, const BufferRange& range);
};

}  // namespace piece

/// All of one kind: what is known to be there, so that nothing is set twice, and what a host had there, so that it
/// gets it back.
template <class Kind, size_t count = 1>
class Piece {
  public:
    using Value = typename Kind::Value;
    static constexpr bool names_objects = std::is_base_of_v<piece::NamesObjects, Kind>;

    /// True where it had to be written. In a borrowed context the host's value is kept first.
    bool set(const Value& value, bool borrowed, GLuint index = 0) {
        Entry& entry = entries_[index];
        if (entry.known == value) return false;
        keep_hosts(index, borrowed);
        Kind::write(index, value);
        entry.known = value;
        return true;
    }
    bool knows(const Value& value, GLuint index) const { return entries_[index].known == value; }
    /// Before something else changes it.
    void disturb(bool borrowed, GLuint index = 0) {
        keep_hosts(index, borrowed);
        entries_[index].known.reset();
    }
    void forget() {
        for (Entry& entry : entries_) entry.known.reset();
    }
    /// As the host had it.
    void give_back() {
        for (GLuint index = 0; index < count; ++index) {
            Entry& entry = entries_[index];
            if (entry.hosts && entry.hosts != entry.known) Kind::write(index, *entry.hosts);
            entry = {};
        }
    }

  private:
    struct Entry {
        std::optional<Value> known{};
        std::optional<Value> hosts{};
    };
    void keep_hosts(GLuint index, bool borrowed) {
        if (borrowed && !entries_[index].hosts) entries_[index].hosts = Kind::read(index);
    }

    std::array<Entry, count> entries_;
};

}  // namespace lumo::backends::gl
