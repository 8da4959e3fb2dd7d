#include "tests/adopt/gl_host.hpp"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <array>
#include <gtest/gtest.h>

namespace lumo::testing_support {
namespace {

EGLDisplay headless_display() {
    const auto get_display =
        reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(eglGetProcAddress("eglGetPlatformDisplayEXT"));
    const auto query_devices =
        reinterpret_cast<PFNEGLQUERYDEVICESEXTPROC>(eglGetProcAddress("eglQueryDevicesEXT"));
    EGLDeviceEXT device = nullptr;
    EGLint devices = 0;
    if (!get_display || !query_devices || !query_devices(1, &device, &devices) || devices < 1)
        return EGL_NO_DISPLAY;
    EGLDisplay display = get_display(EGL_PLATFORM_DEVICE_EXT, device, nullptr);
    return display != EGL_NO_DISPLAY && eglInitialize(display, nullptr, nullptr) ? display : EGL_NO_DISPLAY;
}

GLint limit(GLenum name) {
    GLint value = 0;
    glGetIntegerv(name, &value);
    return value;
}

GLuint make_buffer(GLsizeiptr bytes = 4096) {
    GLuint name = 0;
    glCreateBuffers(1, &name);
    glNamedBufferStorage(name, bytes, nullptr, 0);
    return name;
}

GLuint make_texture(GLenum target) {
    GLuint name = 0;
    glCreateTextures(target, 1, &name);
    switch (target) {
        case GL_TEXTURE_1D:
            glTextureStorage1D(name, 2, GL_RGBA8, 8);
            break;
        case GL_TEXTURE_2D:
        case GL_TEXTURE_CUBE_MAP:
        case GL_TEXTURE_1D_ARRAY:
            glTextureStorage2D(name, 2, GL_RGBA8, 8, 8);
            break;
        case GL_TEXTURE_RECTANGLE:
            glTextureStorage2D(name, 1, GL_RGBA8, 8, 8);
            break;
        case GL_TEXTURE_2D_MULTISAMPLE:
            glTextureStorage2DMultisample(name, 4, GL_RGBA8, 8, 8, GL_TRUE);
            break;
        case GL_TEXTURE_2D_MULTISAMPLE_ARRAY:
            glTextureStorage3DMultisample(name, 4, GL_RGBA8, 8, 8, 2, GL_TRUE);
            break;
        case GL_TEXTURE_BUFFER:
            glTextureBuffer(name, GL_RGBA8, make_buffer());
            break;
        default:
            glTextureStorage3D(name, 2, GL_RGBA8, 8, 8, 6);
    }
    const bool filtered = target == GL_TEXTURE_2D || target == GL_TEXTURE_3D;
    if (filtered) {
        glTextureParameteri(name, GL_TEXTURE_BASE_LEVEL, 1);
        glTextureParameteri(name, GL_TEXTURE_MAX_LEVEL, 1);
        glTextureParameteri(name, GL_TEXTURE_SWIZZLE_R, GL_ZERO);
    }
    return name;
}

/// With subroutines, so that what is chosen of them shows.
GLuint make_program() {
    const char* vertex = R"(#version 450
        subroutine vec4 Pick();
        layout(index = 0) subroutine(Pick) vec4 first() { return vec4(1); }
        layout(index = 1) subroutine(Pick) vec4 second() { return vec4(2); }
        layout(location = 0) subroutine uniform Pick pick;
        void main() { gl_Position = pick(); })";
    const char* fragment = R"(#version 450
        layout(location = 0) out vec4 color;
        void main() { color = vec4(1); })";
    const GLuint program = glCreateProgram();
    for (const auto& [stage, text] :
         {std::pair(GL_VERTEX_SHADER, vertex), std::pair(GL_FRAGMENT_SHADER, fragment)}) {
        const GLuint shader = glCreateShader(GLenum(stage));
        glShaderSource(shader, 1, &text, nullptr);
        glCompileShader(shader);
        glAttachShader(program, shader);
        glDeleteShader(shader);
    }
    glLinkProgram(program);
    return program;
}

void set_programs() {
    const char* text = "#version 450\nlayout(local_size_x = 1) in; void main() {}";
    GLuint pipeline = 0;
    glCreateProgramPipelines(1, &pipeline);
    glUseProgramStages(pipeline, GL_COMPUTE_SHADER_BIT, glCreateShaderProgramv(GL_COMPUTE_SHADER, 1, &text));
    glBindProgramPipeline(pipeline);
    glUseProgram(make_program());
    const GLuint second = 1;
    glUniformSubroutinesuiv(GL_VERTEX_SHADER, 1, &second);
}

void set_buffers() {
    for (GLint i = 0; i < limit(GL_MAX_UNIFORM_BUFFER_BINDINGS); ++i)
        glBindBufferRange(GL_UNIFORM_BUFFER, GLuint(i), make_buffer(), 256, 512);
    for (GLint i = 0; i < limit(GL_MAX_SHADER_STORAGE_BUFFER_BINDINGS); ++i) {
        if (i % 2) {
            glBindBufferBase(GL_SHADER_STORAGE_BUFFER, GLuint(i), make_buffer());
        } else {
            glBindBufferRange(GL_SHADER_STORAGE_BUFFER, GLuint(i), make_buffer(), 256, 512);
        }
    }
    for (GLint i = 0; i < limit(GL_MAX_ATOMIC_COUNTER_BUFFER_BINDINGS); ++i)
        glBindBufferRange(GL_ATOMIC_COUNTER_BUFFER, GLuint(i), make_buffer(), 256, 512);
    GLuint feedback = 0;
    glCreateTransformFeedbacks(1, &feedback);
    glBindTransformFeedback(GL_TRANSFORM_FEEDBACK, feedback);
    for (GLint i = 0; i < limit(GL_MAX_TRANSFORM_FEEDBACK_BUFFERS); ++i)
        glBindBufferRange(GL_TRANSFORM_FEEDBACK_BUFFER, GLuint(i), make_buffer(), 256, 512);
    // The targets' own bindings last: those at points set them too.
    for (GLenum target :
         {GL_ARRAY_BUFFER, GL_ATOMIC_COUNTER_BUFFER, GL_COPY_READ_BUFFER, GL_COPY_WRITE_BUFFER,
          GL_DISPATCH_INDIRECT_BUFFER, GL_DRAW_INDIRECT_BUFFER, GL_PIXEL_PACK_BUFFER, GL_PIXEL_UNPACK_BUFFER,
          GL_QUERY_BUFFER, GL_SHADER_STORAGE_BUFFER, GL_TEXTURE_BUFFER, GL_TRANSFORM_FEEDBACK_BUFFER,
          GL_UNIFORM_BUFFER})
        glBindBuffer(target, make_buffer());
}

void set_units() {
    // The same names on every unit would hide a texture that went to the wrong one; but of a driver's hundreds of
    // units only the first are used by anyone.
    constexpr GLint apart = 40;
    std::vector<GLuint> textures;
    GLuint sampler = 0;
    for (GLint unit = 0; unit < limit(GL_MAX_COMBINED_TEXTURE_IMAGE_UNITS); ++unit) {
        if (unit < apart) {
            textures.clear();
            for (GLenum target :
                 {GL_TEXTURE_1D, GL_TEXTURE_2D, GL_TEXTURE_3D, GL_TEXTURE_CUBE_MAP, GL_TEXTURE_1D_ARRAY,
                  GL_TEXTURE_2D_ARRAY, GL_TEXTURE_CUBE_MAP_ARRAY, GL_TEXTURE_RECTANGLE, GL_TEXTURE_BUFFER,
                  GL_TEXTURE_2D_MULTISAMPLE, GL_TEXTURE_2D_MULTISAMPLE_ARRAY})
                textures.push_back(make_texture(target));
            glCreateSamplers(1, &sampler);
        }
        for (GLuint texture : textures) glBindTextureUnit(GLuint(unit), texture);
        glBindSampler(GLuint(unit), sampler);
    }
    for (GLint unit = 0; unit < limit(GL_MAX_IMAGE_UNITS); ++unit) {
        if (unit % 2) {
            glBindImageTexture(GLuint(unit), make_texture(GL_TEXTURE_3D), 1, GL_FALSE, 3, GL_READ_WRITE,
                               GL_R32UI);
        } else {
            glBindImageTexture(GLuint(unit), make_texture(GL_TEXTURE_2D_ARRAY), 1, GL_TRUE, 2, GL_WRITE_ONLY,
                               GL_RGBA8UI);
        }
    }
    glActiveTexture(GL_TEXTURE5);
}

void set_vertex_array() {
    GLuint array = 0;
    glCreateVertexArrays(1, &array);
    glBindVertexArray(array);
    for (GLint i = 0; i < limit(GL_MAX_VERTEX_ATTRIBS); ++i) {
        glVertexAttrib4f(GLuint(i), 0.1f * float(i), 2, 3, 4);
        glEnableVertexAttribArray(GLuint(i));
        glVertexAttribIFormat(GLuint(i), 2, GL_SHORT, 8);
        glVertexAttribBinding(GLuint(i), GLuint(limit(GL_MAX_VERTEX_ATTRIBS) - 1 - i));
        glBindVertexBuffer(GLuint(i), make_buffer(), 16, 32);
        glVertexBindingDivisor(GLuint(i), 3);
    }
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, make_buffer());
}

void set_framebuffers() {
    for (GLenum target : {GL_DRAW_FRAMEBUFFER, GL_READ_FRAMEBUFFER}) {
        GLuint framebuffer = 0;
        glCreateFramebuffers(1, &framebuffer);
        glBindFramebuffer(target, framebuffer);
        std::array<GLenum, 8> points{};
        for (size_t i = 0; i < points.size(); ++i) {
            glNamedFramebufferTextureLayer(framebuffer, GLenum(GL_COLOR_ATTACHMENT0 + i),
                                           make_texture(GL_TEXTURE_2D_ARRAY), 1, GLint(i % 6));
            points[i] = GLenum(GL_COLOR_ATTACHMENT0 + (i + 1) % points.size());
        }
        glNamedFramebufferDrawBuffers(framebuffer, points.size(), points.data());
        glNamedFramebufferReadBuffer(framebuffer, GL_COLOR_ATTACHMENT3);
    }
    GLuint renderbuffer = 0;
    glCreateRenderbuffers(1, &renderbuffer);
    glBindRenderbuffer(GL_RENDERBUFFER, renderbuffer);
    // Stencil references read as 0 without.
    glNamedRenderbufferStorage(renderbuffer, GL_DEPTH24_STENCIL8, 4, 4);
    glFramebufferRenderbuffer(GL_DRAW_FRAMEBUFFER, GL_DEPTH_STENCIL_ATTACHMENT, GL_RENDERBUFFER,
                              renderbuffer);
}

void set_raster() {
    for (GLenum on : {GL_CLIP_DISTANCE0,
                      GL_CLIP_DISTANCE1,
                      GL_CLIP_DISTANCE2,
                      GL_CLIP_DISTANCE3,
                      GL_CLIP_DISTANCE4,
                      GL_CLIP_DISTANCE5,
                      GL_CLIP_DISTANCE6,
                      GL_CLIP_DISTANCE7,
                      GL_COLOR_LOGIC_OP,
                      GL_CULL_FACE,
                      GL_DEPTH_CLAMP,
                      GL_DEPTH_TEST,
                      GL_FRAMEBUFFER_SRGB,
                      GL_LINE_SMOOTH,
                      GL_POLYGON_OFFSET_FILL,
                      GL_POLYGON_OFFSET_LINE,
                      GL_POLYGON_OFFSET_POINT,
                      GL_POLYGON_SMOOTH,
                      GL_PRIMITIVE_RESTART,
                      GL_PRIMITIVE_RESTART_FIXED_INDEX,
                      GL_PROGRAM_POINT_SIZE,
                      GL_RASTERIZER_DISCARD,
                      GL_SAMPLE_ALPHA_TO_COVERAGE,
                      GL_SAMPLE_ALPHA_TO_ONE,
                      GL_SAMPLE_COVERAGE,
                      GL_SAMPLE_MASK,
                      GL_SAMPLE_SHADING,
                      GL_STENCIL_TEST,
                      GL_TEXTURE_CUBE_MAP_SEAMLESS})
        glEnable(on);
    for (GLenum off : {GL_DITHER, GL_MULTISAMPLE}) glDisable(off);
    for (GLint i = 0; i < limit(GL_MAX_VIEWPORTS); ++i) {
        glEnablei(GL_SCISSOR_TEST, GLuint(i));
        glViewportIndexedf(GLuint(i), 1.5f + float(i), 2.25f, 3.5f, 4.5f);
        glScissorIndexed(GLuint(i), 1, 2, 3, 4 + i);
        glDepthRangeIndexed(GLuint(i), 0.75, 0.25);
    }
    for (GLint i = 0; i < limit(GL_MAX_DRAW_BUFFERS); ++i) {
        glEnablei(GL_BLEND, GLuint(i));
        glBlendFuncSeparatei(GLuint(i), GL_ZERO, GL_CONSTANT_COLOR, GL_DST_ALPHA, GL_SRC_COLOR);
        glBlendEquationSeparatei(GLuint(i), GL_FUNC_REVERSE_SUBTRACT, i % 2 ? GL_MIN : GL_MAX);
        glColorMaski(GLuint(i), i % 2, GL_FALSE, GL_TRUE, GL_FALSE);
    }
    glBlendColor(0.1f, 0.2f, 0.3f, 0.4f);
    glClampColor(GL_CLAMP_READ_COLOR, GL_FALSE);
    glClearColor(0.5f, 0.25f, 0.75f, 1);
    glClearDepth(0.25);
    glClearStencil(7);
    glClipControl(GL_UPPER_LEFT, GL_ZERO_TO_ONE);
    glCullFace(GL_FRONT_AND_BACK);
    glDepthFunc(GL_NOTEQUAL);
    glDepthMask(GL_FALSE);
    glFrontFace(GL_CW);
    for (GLenum hint : {GL_FRAGMENT_SHADER_DERIVATIVE_HINT, GL_LINE_SMOOTH_HINT, GL_POLYGON_SMOOTH_HINT,
                        GL_TEXTURE_COMPRESSION_HINT})
        glHint(hint, GL_NICEST);
    glLineWidth(3);
    glLogicOp(GL_XOR);
    glMinSampleShading(0.5f);
    const std::array<GLfloat, 4> levels{2, 3, 4, 5};
    glPatchParameterfv(GL_PATCH_DEFAULT_INNER_LEVEL, levels.data());
    glPatchParameterfv(GL_PATCH_DEFAULT_OUTER_LEVEL, levels.data());
    glPatchParameteri(GL_PATCH_VERTICES, 5);
    glPointParameterf(GL_POINT_FADE_THRESHOLD_SIZE, 9);
    glPointParameteri(GL_POINT_SPRITE_COORD_ORIGIN, GL_LOWER_LEFT);
    glPointSize(6);
    glPolygonMode(GL_FRONT_AND_BACK, GL_POINT);
    glPolygonOffset(3, 5);
    glPrimitiveRestartIndex(2);
    glProvokingVertex(GL_FIRST_VERTEX_CONVENTION);
    glSampleCoverage(0.25f, GL_TRUE);
    glSampleMaski(0, 0x5);
    for (GLenum face : {GL_FRONT, GL_BACK}) {
        glStencilFuncSeparate(face, GL_NEVER, 3, 0x55);
        glStencilOpSeparate(face, GL_INCR, GL_DECR, GL_INVERT);
        glStencilMaskSeparate(face, 0xaa);
    }
}

void set_pixel_store() {
    for (GLenum name : {GL_PACK_SWAP_BYTES, GL_PACK_LSB_FIRST, GL_UNPACK_SWAP_BYTES, GL_UNPACK_LSB_FIRST})
        glPixelStorei(name, GL_TRUE);
    GLint value = 1;
    for (GLenum name :
         {GL_PACK_ROW_LENGTH, GL_PACK_IMAGE_HEIGHT, GL_PACK_SKIP_PIXELS, GL_PACK_SKIP_ROWS,
          GL_PACK_SKIP_IMAGES, GL_PACK_COMPRESSED_BLOCK_WIDTH, GL_PACK_COMPRESSED_BLOCK_HEIGHT,
          GL_PACK_COMPRESSED_BLOCK_DEPTH, GL_PACK_COMPRESSED_BLOCK_SIZE, GL_UNPACK_ROW_LENGTH,
          GL_UNPACK_IMAGE_HEIGHT, GL_UNPACK_SKIP_PIXELS, GL_UNPACK_SKIP_ROWS, GL_UNPACK_SKIP_IMAGES,
          GL_UNPACK_COMPRESSED_BLOCK_WIDTH, GL_UNPACK_COMPRESSED_BLOCK_HEIGHT,
          GL_UNPACK_COMPRESSED_BLOCK_DEPTH, GL_UNPACK_COMPRESSED_BLOCK_SIZE})
        glPixelStorei(name, value++);
    glPixelStorei(GL_PACK_ALIGNMENT, 8);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 2);
}

}  // namespace

std::unique_ptr<GlHost> GlHost::make(const HostDesc& desc, const GlHost* shared) {
    EGLDisplay display = shared ? shared->display_ : headless_display();
    if (display == EGL_NO_DISPLAY || !eglBindAPI(desc.es ? EGL_OPENGL_ES_API : EGL_OPENGL_API))
        return nullptr;
    std::vector<EGLint> attributes{EGL_CONTEXT_MAJOR_VERSION, desc.major, EGL_CONTEXT_MINOR_VERSION,
                                   desc.minor};
    if (!desc.es) {
        attributes.insert(attributes.end(), {EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                             desc.compatibility ? EGL_CONTEXT_OPENGL_COMPATIBILITY_PROFILE_BIT
                                                                : EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                             EGL_CONTEXT_OPENGL_DEBUG, desc.debug ? EGL_TRUE : EGL_FALSE});
    }
    attributes.push_back(EGL_NONE);
    EGLContext context = eglCreateContext(display, EGL_NO_CONFIG_KHR,
                                          shared ? shared->context_ : EGL_NO_CONTEXT, attributes.data());
    if (context == EGL_NO_CONTEXT) return nullptr;
    std::unique_ptr<GlHost> host(new GlHost(display, context));
    host->make_current();
    return host;
}

GlHost::~GlHost() {
    release();
    eglDestroyContext(display_, context_);
}

void GlHost::make_current() const { eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_); }

void GlHost::release() const {
    if (eglGetCurrentContext() == context_)
        eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
}

std::vector<std::string> set_unusual_state() {
    set_programs();
    set_buffers();
    set_units();
    set_vertex_array();
    set_framebuffers();
    set_raster();
    set_pixel_store();
    EXPECT_EQ(glGetError(), GLenum(GL_NO_ERROR));
    std::vector<std::string> usual{"GL_DEBUG_GROUP_STACK_DEPTH",
                                   "GL_TRANSFORM_FEEDBACK_ACTIVE",
                                   "GL_TRANSFORM_FEEDBACK_PAUSED",
                                   "GL_DEBUG_OUTPUT",
                                   "GL_DEBUG_OUTPUT_SYNCHRONOUS",
                                   "GL_DEBUG_CALLBACK_FUNCTION",
                                   "GL_DEBUG_CALLBACK_USER_PARAM",
                                   "GL_SAMPLES_PASSED",
                                   "GL_ANY_SAMPLES_PASSED",
                                   "GL_ANY_SAMPLES_PASSED_CONSERVATIVE",
                                   "GL_PRIMITIVES_GENERATED",
                                   "GL_TRANSFORM_FEEDBACK_PRIMITIVES_WRITTEN",
                                   "GL_TIME_ELAPSED",
                                   "glGetError"};
    for (GLint unit = 1; unit < limit(GL_MAX_IMAGE_UNITS); unit += 2)
        usual.push_back("GL_IMAGE_BINDING_LAYERED[" + std::to_string(unit) + "]");
    return usual;
}

std::vector<std::string> named_objects(GLuint last) {
    std::vector<std::string> objects;
    for (GLuint name = 1; name <= last; ++name) {
        const auto note = [&](GLboolean is, const char* kind) {
            if (is) objects.push_back(std::string(kind) + " " + std::to_string(name));
        };
        note(glIsBuffer(name), "buffer");
        note(glIsTexture(name), "texture");
        note(glIsSampler(name), "sampler");
        note(glIsProgram(name), "program");
        note(glIsShader(name), "shader");
        note(glIsFramebuffer(name), "framebuffer");
        note(glIsVertexArray(name), "vertex array");
        note(glIsQuery(name), "query");
    }
    return objects;
}

}  // namespace lumo::testing_support
