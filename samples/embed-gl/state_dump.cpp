#include "samples/embed-gl/state_dump.hpp"

#include <array>
#include <epoxy/gl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <set>
#include <span>
#include <string_view>

namespace embed {
namespace {

struct Name {
    std::string_view text;
    GLenum name;
};

constexpr Name capabilities[] = {
    {"GL_CLIP_DISTANCE0", GL_CLIP_DISTANCE0},
    {"GL_CLIP_DISTANCE1", GL_CLIP_DISTANCE1},
    {"GL_CLIP_DISTANCE2", GL_CLIP_DISTANCE2},
    {"GL_CLIP_DISTANCE3", GL_CLIP_DISTANCE3},
    {"GL_CLIP_DISTANCE4", GL_CLIP_DISTANCE4},
    {"GL_CLIP_DISTANCE5", GL_CLIP_DISTANCE5},
    {"GL_CLIP_DISTANCE6", GL_CLIP_DISTANCE6},
    {"GL_CLIP_DISTANCE7", GL_CLIP_DISTANCE7},
    {"GL_COLOR_LOGIC_OP", GL_COLOR_LOGIC_OP},
    {"GL_CULL_FACE", GL_CULL_FACE},
    {"GL_DEBUG_OUTPUT", GL_DEBUG_OUTPUT},
    {"GL_DEBUG_OUTPUT_SYNCHRONOUS", GL_DEBUG_OUTPUT_SYNCHRONOUS},
    {"GL_DEPTH_CLAMP", GL_DEPTH_CLAMP},
    {"GL_DEPTH_TEST", GL_DEPTH_TEST},
    {"GL_DITHER", GL_DITHER},
    {"GL_FRAMEBUFFER_SRGB", GL_FRAMEBUFFER_SRGB},
    {"GL_LINE_SMOOTH", GL_LINE_SMOOTH},
    {"GL_MULTISAMPLE", GL_MULTISAMPLE},
    {"GL_POLYGON_OFFSET_FILL", GL_POLYGON_OFFSET_FILL},
    {"GL_POLYGON_OFFSET_LINE", GL_POLYGON_OFFSET_LINE},
    {"GL_POLYGON_OFFSET_POINT", GL_POLYGON_OFFSET_POINT},
    {"GL_POLYGON_SMOOTH", GL_POLYGON_SMOOTH},
    {"GL_PRIMITIVE_RESTART", GL_PRIMITIVE_RESTART},
    {"GL_PRIMITIVE_RESTART_FIXED_INDEX", GL_PRIMITIVE_RESTART_FIXED_INDEX},
    {"GL_PROGRAM_POINT_SIZE", GL_PROGRAM_POINT_SIZE},
    {"GL_RASTERIZER_DISCARD", GL_RASTERIZER_DISCARD},
    {"GL_SAMPLE_ALPHA_TO_COVERAGE", GL_SAMPLE_ALPHA_TO_COVERAGE},
    {"GL_SAMPLE_ALPHA_TO_ONE", GL_SAMPLE_ALPHA_TO_ONE},
    {"GL_SAMPLE_COVERAGE", GL_SAMPLE_COVERAGE},
    {"GL_SAMPLE_MASK", GL_SAMPLE_MASK},
    {"GL_SAMPLE_SHADING", GL_SAMPLE_SHADING},
    {"GL_STENCIL_TEST", GL_STENCIL_TEST},
    {"GL_TEXTURE_CUBE_MAP_SEAMLESS", GL_TEXTURE_CUBE_MAP_SEAMLESS},
};

/// Numbers, up to four of each.
constexpr Name numbers[] = {
    {"GL_ACTIVE_TEXTURE", GL_ACTIVE_TEXTURE},
    {"GL_ARRAY_BUFFER_BINDING", GL_ARRAY_BUFFER_BINDING},
    {"GL_ATOMIC_COUNTER_BUFFER_BINDING", GL_ATOMIC_COUNTER_BUFFER_BINDING},
    {"GL_BLEND_COLOR", GL_BLEND_COLOR},
    {"GL_CLAMP_READ_COLOR", GL_CLAMP_READ_COLOR},
    {"GL_CLIP_DEPTH_MODE", GL_CLIP_DEPTH_MODE},
    {"GL_CLIP_ORIGIN", GL_CLIP_ORIGIN},
    {"GL_COLOR_CLEAR_VALUE", GL_COLOR_CLEAR_VALUE},
    {"GL_COPY_READ_BUFFER_BINDING", GL_COPY_READ_BUFFER_BINDING},
    {"GL_COPY_WRITE_BUFFER_BINDING", GL_COPY_WRITE_BUFFER_BINDING},
    {"GL_CULL_FACE_MODE", GL_CULL_FACE_MODE},
    {"GL_CURRENT_PROGRAM", GL_CURRENT_PROGRAM},
    {"GL_DEBUG_GROUP_STACK_DEPTH", GL_DEBUG_GROUP_STACK_DEPTH},
    {"GL_DEPTH_CLEAR_VALUE", GL_DEPTH_CLEAR_VALUE},
    {"GL_DEPTH_FUNC", GL_DEPTH_FUNC},
    {"GL_DEPTH_WRITEMASK", GL_DEPTH_WRITEMASK},
    {"GL_DISPATCH_INDIRECT_BUFFER_BINDING", GL_DISPATCH_INDIRECT_BUFFER_BINDING},
    {"GL_DRAW_FRAMEBUFFER_BINDING", GL_DRAW_FRAMEBUFFER_BINDING},
    {"GL_DRAW_INDIRECT_BUFFER_BINDING", GL_DRAW_INDIRECT_BUFFER_BINDING},
    {"GL_FRAGMENT_SHADER_DERIVATIVE_HINT", GL_FRAGMENT_SHADER_DERIVATIVE_HINT},
    {"GL_FRONT_FACE", GL_FRONT_FACE},
    {"GL_LINE_SMOOTH_HINT", GL_LINE_SMOOTH_HINT},
    {"GL_LINE_WIDTH", GL_LINE_WIDTH},
    {"GL_LOGIC_OP_MODE", GL_LOGIC_OP_MODE},
    {"GL_MIN_SAMPLE_SHADING_VALUE", GL_MIN_SAMPLE_SHADING_VALUE},
    {"GL_PATCH_DEFAULT_INNER_LEVEL", GL_PATCH_DEFAULT_INNER_LEVEL},
    {"GL_PATCH_DEFAULT_OUTER_LEVEL", GL_PATCH_DEFAULT_OUTER_LEVEL},
    {"GL_PATCH_VERTICES", GL_PATCH_VERTICES},
    {"GL_PIXEL_PACK_BUFFER_BINDING", GL_PIXEL_PACK_BUFFER_BINDING},
    {"GL_PIXEL_UNPACK_BUFFER_BINDING", GL_PIXEL_UNPACK_BUFFER_BINDING},
    {"GL_POINT_FADE_THRESHOLD_SIZE", GL_POINT_FADE_THRESHOLD_SIZE},
    {"GL_POINT_SIZE", GL_POINT_SIZE},
    {"GL_POINT_SPRITE_COORD_ORIGIN", GL_POINT_SPRITE_COORD_ORIGIN},
    {"GL_POLYGON_MODE", GL_POLYGON_MODE},
    {"GL_POLYGON_OFFSET_FACTOR", GL_POLYGON_OFFSET_FACTOR},
    {"GL_POLYGON_OFFSET_UNITS", GL_POLYGON_OFFSET_UNITS},
    {"GL_POLYGON_SMOOTH_HINT", GL_POLYGON_SMOOTH_HINT},
    {"GL_PRIMITIVE_RESTART_INDEX", GL_PRIMITIVE_RESTART_INDEX},
    {"GL_PROGRAM_PIPELINE_BINDING", GL_PROGRAM_PIPELINE_BINDING},
    {"GL_PROVOKING_VERTEX", GL_PROVOKING_VERTEX},
    {"GL_QUERY_BUFFER_BINDING", GL_QUERY_BUFFER_BINDING},
    {"GL_READ_BUFFER", GL_READ_BUFFER},
    {"GL_READ_FRAMEBUFFER_BINDING", GL_READ_FRAMEBUFFER_BINDING},
    {"GL_RENDERBUFFER_BINDING", GL_RENDERBUFFER_BINDING},
    {"GL_SAMPLE_COVERAGE_INVERT", GL_SAMPLE_COVERAGE_INVERT},
    {"GL_SAMPLE_COVERAGE_VALUE", GL_SAMPLE_COVERAGE_VALUE},
    {"GL_SHADER_STORAGE_BUFFER_BINDING", GL_SHADER_STORAGE_BUFFER_BINDING},
    {"GL_STENCIL_CLEAR_VALUE", GL_STENCIL_CLEAR_VALUE},
    {"GL_TEXTURE_BUFFER_BINDING", GL_TEXTURE_BUFFER_BINDING},
    {"GL_TEXTURE_COMPRESSION_HINT", GL_TEXTURE_COMPRESSION_HINT},
    {"GL_TRANSFORM_FEEDBACK_ACTIVE", GL_TRANSFORM_FEEDBACK_ACTIVE},
    {"GL_TRANSFORM_FEEDBACK_BINDING", GL_TRANSFORM_FEEDBACK_BINDING},
    {"GL_TRANSFORM_FEEDBACK_BUFFER_BINDING", GL_TRANSFORM_FEEDBACK_BUFFER_BINDING},
    {"GL_TRANSFORM_FEEDBACK_PAUSED", GL_TRANSFORM_FEEDBACK_PAUSED},
    {"GL_UNIFORM_BUFFER_BINDING", GL_UNIFORM_BUFFER_BINDING},
    {"GL_VERTEX_ARRAY_BINDING", GL_VERTEX_ARRAY_BINDING},
    {"GL_STENCIL_FAIL", GL_STENCIL_FAIL},
    {"GL_STENCIL_FUNC", GL_STENCIL_FUNC},
    {"GL_STENCIL_PASS_DEPTH_FAIL", GL_STENCIL_PASS_DEPTH_FAIL},
    {"GL_STENCIL_PASS_DEPTH_PASS", GL_STENCIL_PASS_DEPTH_PASS},
    {"GL_STENCIL_REF", GL_STENCIL_REF},
    {"GL_STENCIL_VALUE_MASK", GL_STENCIL_VALUE_MASK},
    {"GL_STENCIL_WRITEMASK", GL_STENCIL_WRITEMASK},
    {"GL_STENCIL_BACK_FAIL", GL_STENCIL_BACK_FAIL},
    {"GL_STENCIL_BACK_FUNC", GL_STENCIL_BACK_FUNC},
    {"GL_STENCIL_BACK_PASS_DEPTH_FAIL", GL_STENCIL_BACK_PASS_DEPTH_FAIL},
    {"GL_STENCIL_BACK_PASS_DEPTH_PASS", GL_STENCIL_BACK_PASS_DEPTH_PASS},
    {"GL_STENCIL_BACK_REF", GL_STENCIL_BACK_REF},
    {"GL_STENCIL_BACK_VALUE_MASK", GL_STENCIL_BACK_VALUE_MASK},
    {"GL_STENCIL_BACK_WRITEMASK", GL_STENCIL_BACK_WRITEMASK},
    {"GL_DRAW_BUFFER0", GL_DRAW_BUFFER0},
    {"GL_DRAW_BUFFER1", GL_DRAW_BUFFER1},
    {"GL_DRAW_BUFFER2", GL_DRAW_BUFFER2},
    {"GL_DRAW_BUFFER3", GL_DRAW_BUFFER3},
    {"GL_DRAW_BUFFER4", GL_DRAW_BUFFER4},
    {"GL_DRAW_BUFFER5", GL_DRAW_BUFFER5},
    {"GL_DRAW_BUFFER6", GL_DRAW_BUFFER6},
    {"GL_DRAW_BUFFER7", GL_DRAW_BUFFER7},
    {"GL_PACK_SWAP_BYTES", GL_PACK_SWAP_BYTES},
    {"GL_PACK_LSB_FIRST", GL_PACK_LSB_FIRST},
    {"GL_PACK_ROW_LENGTH", GL_PACK_ROW_LENGTH},
    {"GL_PACK_IMAGE_HEIGHT", GL_PACK_IMAGE_HEIGHT},
    {"GL_PACK_SKIP_PIXELS", GL_PACK_SKIP_PIXELS},
    {"GL_PACK_SKIP_ROWS", GL_PACK_SKIP_ROWS},
    {"GL_PACK_SKIP_IMAGES", GL_PACK_SKIP_IMAGES},
    {"GL_PACK_ALIGNMENT", GL_PACK_ALIGNMENT},
    {"GL_PACK_COMPRESSED_BLOCK_WIDTH", GL_PACK_COMPRESSED_BLOCK_WIDTH},
    {"GL_PACK_COMPRESSED_BLOCK_HEIGHT", GL_PACK_COMPRESSED_BLOCK_HEIGHT},
    {"GL_PACK_COMPRESSED_BLOCK_DEPTH", GL_PACK_COMPRESSED_BLOCK_DEPTH},
    {"GL_PACK_COMPRESSED_BLOCK_SIZE", GL_PACK_COMPRESSED_BLOCK_SIZE},
    {"GL_UNPACK_SWAP_BYTES", GL_UNPACK_SWAP_BYTES},
    {"GL_UNPACK_LSB_FIRST", GL_UNPACK_LSB_FIRST},
    {"GL_UNPACK_ROW_LENGTH", GL_UNPACK_ROW_LENGTH},
    {"GL_UNPACK_IMAGE_HEIGHT", GL_UNPACK_IMAGE_HEIGHT},
    {"GL_UNPACK_SKIP_PIXELS", GL_UNPACK_SKIP_PIXELS},
    {"GL_UNPACK_SKIP_ROWS", GL_UNPACK_SKIP_ROWS},
    {"GL_UNPACK_SKIP_IMAGES", GL_UNPACK_SKIP_IMAGES},
    {"GL_UNPACK_ALIGNMENT", GL_UNPACK_ALIGNMENT},
    {"GL_UNPACK_COMPRESSED_BLOCK_WIDTH", GL_UNPACK_COMPRESSED_BLOCK_WIDTH},
    {"GL_UNPACK_COMPRESSED_BLOCK_HEIGHT", GL_UNPACK_COMPRESSED_BLOCK_HEIGHT},
    {"GL_UNPACK_COMPRESSED_BLOCK_DEPTH", GL_UNPACK_COMPRESSED_BLOCK_DEPTH},
    {"GL_UNPACK_COMPRESSED_BLOCK_SIZE", GL_UNPACK_COMPRESSED_BLOCK_SIZE},
};

constexpr Name viewport_numbers[] = {
    {"GL_VIEWPORT", GL_VIEWPORT},
    {"GL_SCISSOR_BOX", GL_SCISSOR_BOX},
    {"GL_DEPTH_RANGE", GL_DEPTH_RANGE},
};
constexpr Name color_target_numbers[] = {
    {"GL_BLEND_SRC_RGB", GL_BLEND_SRC_RGB},           {"GL_BLEND_DST_RGB", GL_BLEND_DST_RGB},
    {"GL_BLEND_SRC_ALPHA", GL_BLEND_SRC_ALPHA},       {"GL_BLEND_DST_ALPHA", GL_BLEND_DST_ALPHA},
    {"GL_BLEND_EQUATION_RGB", GL_BLEND_EQUATION_RGB}, {"GL_BLEND_EQUATION_ALPHA", GL_BLEND_EQUATION_ALPHA},
    {"GL_COLOR_WRITEMASK", GL_COLOR_WRITEMASK},
};
constexpr Name image_unit_numbers[] = {
    {"GL_IMAGE_BINDING_NAME", GL_IMAGE_BINDING_NAME},
    {"GL_IMAGE_BINDING_LEVEL", GL_IMAGE_BINDING_LEVEL},
    {"GL_IMAGE_BINDING_LAYERED", GL_IMAGE_BINDING_LAYERED},
    {"GL_IMAGE_BINDING_LAYER", GL_IMAGE_BINDING_LAYER},
    {"GL_IMAGE_BINDING_ACCESS", GL_IMAGE_BINDING_ACCESS},
    {"GL_IMAGE_BINDING_FORMAT", GL_IMAGE_BINDING_FORMAT},
};

/// Buffers at indexed points.
struct BufferPoints {
    std::string_view text;
    GLenum count, binding, start, size;
};
constexpr BufferPoints buffer_points[] = {
    {"uniform buffer", GL_MAX_UNIFORM_BUFFER_BINDINGS, GL_UNIFORM_BUFFER_BINDING, GL_UNIFORM_BUFFER_START,
     GL_UNIFORM_BUFFER_SIZE},
    {"storage buffer", GL_MAX_SHADER_STORAGE_BUFFER_BINDINGS, GL_SHADER_STORAGE_BUFFER_BINDING,
     GL_SHADER_STORAGE_BUFFER_START, GL_SHADER_STORAGE_BUFFER_SIZE},
    {"atomic counter buffer", GL_MAX_ATOMIC_COUNTER_BUFFER_BINDINGS, GL_ATOMIC_COUNTER_BUFFER_BINDING,
     GL_ATOMIC_COUNTER_BUFFER_START, GL_ATOMIC_COUNTER_BUFFER_SIZE},
    {"transform feedback buffer", GL_MAX_TRANSFORM_FEEDBACK_BUFFERS, GL_TRANSFORM_FEEDBACK_BUFFER_BINDING,
     GL_TRANSFORM_FEEDBACK_BUFFER_START, GL_TRANSFORM_FEEDBACK_BUFFER_SIZE},
};

/// What a texture unit holds, for the active unit.
constexpr Name unit_bindings[] = {
    {"GL_TEXTURE_BINDING_1D", GL_TEXTURE_BINDING_1D},
    {"GL_TEXTURE_BINDING_2D", GL_TEXTURE_BINDING_2D},
    {"GL_TEXTURE_BINDING_3D", GL_TEXTURE_BINDING_3D},
    {"GL_TEXTURE_BINDING_1D_ARRAY", GL_TEXTURE_BINDING_1D_ARRAY},
    {"GL_TEXTURE_BINDING_2D_ARRAY", GL_TEXTURE_BINDING_2D_ARRAY},
    {"GL_TEXTURE_BINDING_CUBE_MAP", GL_TEXTURE_BINDING_CUBE_MAP},
    {"GL_TEXTURE_BINDING_CUBE_MAP_ARRAY", GL_TEXTURE_BINDING_CUBE_MAP_ARRAY},
    {"GL_TEXTURE_BINDING_RECTANGLE", GL_TEXTURE_BINDING_RECTANGLE},
    {"GL_TEXTURE_BINDING_BUFFER", GL_TEXTURE_BINDING_BUFFER},
    {"GL_TEXTURE_BINDING_2D_MULTISAMPLE", GL_TEXTURE_BINDING_2D_MULTISAMPLE},
    {"GL_TEXTURE_BINDING_2D_MULTISAMPLE_ARRAY", GL_TEXTURE_BINDING_2D_MULTISAMPLE_ARRAY},
    {"GL_SAMPLER_BINDING", GL_SAMPLER_BINDING},
};
constexpr Name texture_parameters[] = {
    {"GL_TEXTURE_BASE_LEVEL", GL_TEXTURE_BASE_LEVEL},
    {"GL_TEXTURE_MAX_LEVEL", GL_TEXTURE_MAX_LEVEL},
    {"GL_TEXTURE_MIN_LOD", GL_TEXTURE_MIN_LOD},
    {"GL_TEXTURE_MAX_LOD", GL_TEXTURE_MAX_LOD},
    {"GL_TEXTURE_LOD_BIAS", GL_TEXTURE_LOD_BIAS},
    {"GL_TEXTURE_MIN_FILTER", GL_TEXTURE_MIN_FILTER},
    {"GL_TEXTURE_MAG_FILTER", GL_TEXTURE_MAG_FILTER},
    {"GL_TEXTURE_WRAP_S", GL_TEXTURE_WRAP_S},
    {"GL_TEXTURE_WRAP_T", GL_TEXTURE_WRAP_T},
    {"GL_TEXTURE_WRAP_R", GL_TEXTURE_WRAP_R},
    {"GL_TEXTURE_COMPARE_MODE", GL_TEXTURE_COMPARE_MODE},
    {"GL_TEXTURE_COMPARE_FUNC", GL_TEXTURE_COMPARE_FUNC},
    {"GL_TEXTURE_SWIZZLE_RGBA", GL_TEXTURE_SWIZZLE_RGBA},
    {"GL_TEXTURE_BORDER_COLOR", GL_TEXTURE_BORDER_COLOR},
};
constexpr Name attribute_parameters[] = {
    {"GL_VERTEX_ATTRIB_ARRAY_ENABLED", GL_VERTEX_ATTRIB_ARRAY_ENABLED},
    {"GL_VERTEX_ATTRIB_ARRAY_SIZE", GL_VERTEX_ATTRIB_ARRAY_SIZE},
    {"GL_VERTEX_ATTRIB_ARRAY_STRIDE", GL_VERTEX_ATTRIB_ARRAY_STRIDE},
    {"GL_VERTEX_ATTRIB_ARRAY_TYPE", GL_VERTEX_ATTRIB_ARRAY_TYPE},
    {"GL_VERTEX_ATTRIB_ARRAY_NORMALIZED", GL_VERTEX_ATTRIB_ARRAY_NORMALIZED},
    {"GL_VERTEX_ATTRIB_ARRAY_INTEGER", GL_VERTEX_ATTRIB_ARRAY_INTEGER},
    {"GL_VERTEX_ATTRIB_ARRAY_LONG", GL_VERTEX_ATTRIB_ARRAY_LONG},
    {"GL_VERTEX_ATTRIB_ARRAY_DIVISOR", GL_VERTEX_ATTRIB_ARRAY_DIVISOR},
    {"GL_VERTEX_ATTRIB_ARRAY_BUFFER_BINDING", GL_VERTEX_ATTRIB_ARRAY_BUFFER_BINDING},
    {"GL_VERTEX_ATTRIB_BINDING", GL_VERTEX_ATTRIB_BINDING},
    {"GL_VERTEX_ATTRIB_RELATIVE_OFFSET", GL_VERTEX_ATTRIB_RELATIVE_OFFSET},
    {"GL_CURRENT_VERTEX_ATTRIB", GL_CURRENT_VERTEX_ATTRIB},
};
constexpr Name attachment_parameters[] = {
    {"GL_FRAMEBUFFER_ATTACHMENT_OBJECT_NAME", GL_FRAMEBUFFER_ATTACHMENT_OBJECT_NAME},
    {"GL_FRAMEBUFFER_ATTACHMENT_TEXTURE_LEVEL", GL_FRAMEBUFFER_ATTACHMENT_TEXTURE_LEVEL},
    {"GL_FRAMEBUFFER_ATTACHMENT_TEXTURE_LAYER", GL_FRAMEBUFFER_ATTACHMENT_TEXTURE_LAYER},
    {"GL_FRAMEBUFFER_ATTACHMENT_LAYERED", GL_FRAMEBUFFER_ATTACHMENT_LAYERED},
};
constexpr Name queries[] = {
    {"GL_SAMPLES_PASSED", GL_SAMPLES_PASSED},
    {"GL_ANY_SAMPLES_PASSED", GL_ANY_SAMPLES_PASSED},
    {"GL_ANY_SAMPLES_PASSED_CONSERVATIVE", GL_ANY_SAMPLES_PASSED_CONSERVATIVE},
    {"GL_PRIMITIVES_GENERATED", GL_PRIMITIVES_GENERATED},
    {"GL_TRANSFORM_FEEDBACK_PRIMITIVES_WRITTEN", GL_TRANSFORM_FEEDBACK_PRIMITIVES_WRITTEN},
    {"GL_TIME_ELAPSED", GL_TIME_ELAPSED},
};
struct Stage {
    GLenum stage, subroutine_uniforms;
};
constexpr Stage stages[] = {
    {GL_VERTEX_SHADER, GL_VERTEX_SUBROUTINE_UNIFORM},
    {GL_TESS_CONTROL_SHADER, GL_TESS_CONTROL_SUBROUTINE_UNIFORM},
    {GL_TESS_EVALUATION_SHADER, GL_TESS_EVALUATION_SUBROUTINE_UNIFORM},
    {GL_GEOMETRY_SHADER, GL_GEOMETRY_SUBROUTINE_UNIFORM},
    {GL_FRAGMENT_SHADER, GL_FRAGMENT_SUBROUTINE_UNIFORM},
    {GL_COMPUTE_SHADER, GL_COMPUTE_SUBROUTINE_UNIFORM},
};

GLint integer(GLenum name) {
    std::array<GLint, 4> values{};
    glGetIntegerv(name, values.data());
    return values[0];
}

class Dump {
  public:
    StateDump read() {
        for (const Name& name : capabilities) put(name.text, bool(glIsEnabled(name.name)));
        for (const Name& name : numbers) {
            std::array<GLdouble, 4> values{};
            glGetDoublev(name.name, values.data());
            put(name.text, values);
        }
        read_debug();
        read_indexed();
        read_units();
        read_vertex_array();
        read_framebuffer("draw framebuffer", GL_DRAW_FRAMEBUFFER, GL_DRAW_FRAMEBUFFER_BINDING);
        read_framebuffer("read framebuffer", GL_READ_FRAMEBUFFER, GL_READ_FRAMEBUFFER_BINDING);
        read_subroutines();
        for (const Name& query : queries) {
            GLint running = 0;
            glGetQueryiv(query.name, GL_CURRENT_QUERY, &running);
            put(query.text, running);
        }
        put("glGetError", glGetError());
        return std::move(dump_);
    }

  private:
    template <class T>
    void put(std::string_view name, const T& value) {
        dump_.emplace(name, fmt::format("{}", value));
    }
    template <class T>
    void put(std::string_view name, GLint index, const T& value) {
        put(fmt::format("{}[{}]", name, index), value);
    }

    void read_debug() {
        for (const Name& name : {Name{"GL_DEBUG_CALLBACK_FUNCTION", GL_DEBUG_CALLBACK_FUNCTION},
                                 Name{"GL_DEBUG_CALLBACK_USER_PARAM", GL_DEBUG_CALLBACK_USER_PARAM}}) {
            GLvoid* value = nullptr;
            glGetPointerv(name.name, &value);
            put(name.text, fmt::ptr(value));
        }
    }

    void read_indexed() {
        for (GLint i = 0; i < integer(GL_MAX_VIEWPORTS); ++i) {
            put("GL_SCISSOR_TEST", i, bool(glIsEnabledi(GL_SCISSOR_TEST, GLuint(i))));
            read_numbers(viewport_numbers, i);
        }
        for (GLint i = 0; i < integer(GL_MAX_DRAW_BUFFERS); ++i) {
            put("GL_BLEND", i, bool(glIsEnabledi(GL_BLEND, GLuint(i))));
            read_numbers(color_target_numbers, i);
        }
        for (GLint i = 0; i < integer(GL_MAX_IMAGE_UNITS); ++i) read_numbers(image_unit_numbers, i);
        for (const BufferPoints& points : buffer_points) {
            for (GLint i = 0; i < integer(points.count); ++i) {
                GLint buffer = 0;
                GLint64 start = 0, size = 0;
                glGetIntegeri_v(points.binding, GLuint(i), &buffer);
                glGetInteger64i_v(points.start, GLuint(i), &start);
                glGetInteger64i_v(points.size, GLuint(i), &size);
                put(points.text, i, fmt::format("{} from {}, {} bytes", buffer, start, size));
            }
        }
        GLint mask = 0;
        glGetIntegeri_v(GL_SAMPLE_MASK_VALUE, 0, &mask);
        put("GL_SAMPLE_MASK_VALUE", mask);
    }
    void read_numbers(std::span<const Name> names, GLint index) {
        for (const Name& name : names) {
            std::array<GLdouble, 4> values{};
            glGetDoublei_v(name.name, GLuint(index), values.data());
            put(name.text, index, values);
        }
    }

    void read_units() {
        const GLint active = integer(GL_ACTIVE_TEXTURE);
        for (GLint unit = 0; unit < integer(GL_MAX_COMBINED_TEXTURE_IMAGE_UNITS); ++unit) {
            glActiveTexture(GLenum(GL_TEXTURE0 + unit));
            for (const Name& name : unit_bindings) {
                const GLint bound = integer(name.name);
                put(name.text, unit, bound);
                if (bound && name.name != GL_SAMPLER_BINDING) read_texture(GLuint(bound));
            }
        }
        glActiveTexture(GLenum(active));
    }
    void read_texture(GLuint texture) {
        if (!textures_.insert(texture).second) return;
        for (const Name& name : texture_parameters) {
            std::array<GLfloat, 4> values{};
            glGetTextureParameterfv(texture, name.name, values.data());
            put(fmt::format("texture {} {}", texture, name.text), values);
        }
    }

    void read_vertex_array() {
        if (!integer(GL_VERTEX_ARRAY_BINDING)) return;
        put("GL_ELEMENT_ARRAY_BUFFER_BINDING", integer(GL_ELEMENT_ARRAY_BUFFER_BINDING));
        for (GLint i = 0; i < integer(GL_MAX_VERTEX_ATTRIBS); ++i) {
            for (const Name& name : attribute_parameters) {
                std::array<GLdouble, 4> values{};
                glGetVertexAttribdv(GLuint(i), name.name, values.data());
                put(name.text, i, values);
            }
        }
    }

    void read_framebuffer(std::string_view text, GLenum target, GLenum binding) {
        if (!integer(binding)) return;
        std::vector<GLenum> points{GL_DEPTH_ATTACHMENT, GL_STENCIL_ATTACHMENT};
        for (GLint i = 0; i < integer(GL_MAX_COLOR_ATTACHMENTS); ++i)
            points.push_back(GLenum(GL_COLOR_ATTACHMENT0 + i));
        for (GLenum point : points) {
            GLint type = GL_NONE;
            glGetFramebufferAttachmentParameteriv(target, point, GL_FRAMEBUFFER_ATTACHMENT_OBJECT_TYPE,
                                                  &type);
            put(fmt::format("{} {:#x}", text, point), type);
            if (type != GL_TEXTURE) continue;
            for (const Name& name : attachment_parameters) {
                GLint value = 0;
                glGetFramebufferAttachmentParameteriv(target, point, name.name, &value);
                put(fmt::format("{} {:#x} {}", text, point, name.text), value);
            }
        }
    }

    void read_subroutines() {
        const auto program = GLuint(integer(GL_CURRENT_PROGRAM));
        if (!program) return;
        for (const auto [stage, uniforms] : stages) {
            GLint used = 0, locations = 0;
            glGetProgramInterfaceiv(program, uniforms, GL_ACTIVE_RESOURCES, &used);
            if (!used) continue;  // perhaps the program has no such stage, of which nothing may be asked
            glGetProgramStageiv(program, stage, GL_ACTIVE_SUBROUTINE_UNIFORM_LOCATIONS, &locations);
            for (GLint i = 0; i < locations; ++i) {
                GLuint index = 0;
                glGetUniformSubroutineuiv(stage, i, &index);
                put(fmt::format("subroutine of stage {:#x}", stage), i, index);
            }
        }
    }

    StateDump dump_;
    std::set<GLuint> textures_;  ///< read already
};

}  // namespace

StateDump dump_state() { return Dump().read(); }

std::vector<std::string> differences(const StateDump& before, const StateDump& after) {
    std::vector<std::string> lines;
    for (const auto& [name, value] : before) {
        const auto found = after.find(name);
        const std::string& now = found == after.end() ? std::string("gone") : found->second;
        if (now != value) lines.push_back(fmt::format("{}: {} became {}", name, value, now));
    }
    for (const auto& [name, value] : after)
        if (!before.contains(name)) lines.push_back(fmt::format("{}: {} appeared", name, value));
    return lines;
}

}  // namespace embed
