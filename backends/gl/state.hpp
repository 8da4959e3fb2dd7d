// What is bound and set in the context: one list of pieces. It spares calls that would change nothing, and in a
// host's context it is what the host gets back.
#pragma once

#include <optional>
#include <tuple>

#include "backends/gl/pieces.hpp"
#include "rhi/work.hpp"

namespace lumo::backends::gl {

/// What every driver has.
inline constexpr GLuint max_color_targets = 8;

/// Nothing in the backend sets state of the context but through here. Each function makes its pieces so unless they
/// are known to be. In a borrowed context a piece is read before it is first written, so that what lumo does not
/// use costs the host nothing.
class BoundState {
  public:
    explicit BoundState(bool borrowed) : borrowed_(borrowed) {}

    /// Objects were deleted: what is bound by name is not known any more.
    void forget_objects();
    /// Everything as the host had it.
    void give_back();

    void program(GLuint name);
    void vertex_array(GLuint name) { set<piece::VertexArray>(name); }
    void framebuffer(GLuint name) { set<piece::Framebuffer>(name); }
    void texture(GLuint unit, rhi::Dimension dimension, GLuint name, GLuint sampler);
    void image(GLuint unit, const ImageBinding& image) { set<piece::ImageAt, slots>(image, unit); }
    void storage(GLuint slot, const BufferRange& range);
    void uniform(GLuint slot, const BufferRange& range);
    void draw_indirect(GLuint buffer) { set<piece::DrawIndirectBuffer>(buffer); }
    void dispatch_indirect(GLuint buffer) { set<piece::DispatchIndirectBuffer>(buffer); }
    /// Texels go from and to buffers tightly packed.
    void pack(GLuint buffer);
    void unpack(GLuint buffer);
    /// The results of queries go to the host's memory.
    void no_query_buffer() { set<piece::QueryBuffer>(0); }

    void raster(const rhi::RasterState& state);
    /// For clears and blits, which obey masks and the scissor: opens them all.
    void open_masks();
    /// Lower left corner and size; clips to it too.
    void viewport(const rhi::Viewport& viewport);
    void encode_srgb(bool on) { set<piece::Enabled<GL_FRAMEBUFFER_SRGB>>(on); }

  private:
    static constexpr size_t slots = rhi::max_bindings + 1;  // of each kind; one more for push constants
    static constexpr size_t color_targets = max_color_targets;

    template <GLenum... names>
    using AllEnabled = std::tuple<Piece<piece::Enabled<names>>...>;
    template <GLenum... names>
    using AllPixelStores = std::tuple<Piece<piece::PixelStore<names>>...>;

    /// Off for every draw, clear and blit of lumo's, which uses none of them. (Mesa offsets filled polygons by either
    /// of the other offsets too.)
    using Unused =
        AllEnabled<GL_DITHER, GL_STENCIL_TEST, GL_COLOR_LOGIC_OP, GL_RASTERIZER_DISCARD, GL_PRIMITIVE_RESTART,
                   GL_PRIMITIVE_RESTART_FIXED_INDEX, GL_SAMPLE_ALPHA_TO_COVERAGE, GL_SAMPLE_ALPHA_TO_ONE,
                   GL_SAMPLE_COVERAGE, GL_SAMPLE_MASK, GL_SAMPLE_SHADING, GL_LINE_SMOOTH, GL_POLYGON_SMOOTH,
                   GL_POLYGON_OFFSET_LINE, GL_POLYGON_OFFSET_POINT, GL_CLIP_DISTANCE0, GL_CLIP_DISTANCE1,
                   GL_CLIP_DISTANCE2, GL_CLIP_DISTANCE3, GL_CLIP_DISTANCE4, GL_CLIP_DISTANCE5,
                   GL_CLIP_DISTANCE6, GL_CLIP_DISTANCE7>;
    /// 0 for every transfer of texels; alignments apart, which are 1.
    using Packing =
        AllPixelStores<GL_PACK_SWAP_BYTES, GL_PACK_LSB_FIRST, GL_PACK_ROW_LENGTH, GL_PACK_IMAGE_HEIGHT,
                       GL_PACK_SKIP_PIXELS, GL_PACK_SKIP_ROWS, GL_PACK_SKIP_IMAGES,
                       GL_PACK_COMPRESSED_BLOCK_WIDTH, GL_PACK_COMPRESSED_BLOCK_HEIGHT,
                       GL_PACK_COMPRESSED_BLOCK_DEPTH, GL_PACK_COMPRESSED_BLOCK_SIZE>;
    using Unpacking = AllPixelStores<
        GL_UNPACK_SWAP_BYTES, GL_UNPACK_LSB_FIRST, GL_UNPACK_ROW_LENGTH, GL_UNPACK_IMAGE_HEIGHT,
        GL_UNPACK_SKIP_PIXELS, GL_UNPACK_SKIP_ROWS, GL_UNPACK_SKIP_IMAGES, GL_UNPACK_COMPRESSED_BLOCK_WIDTH,
        GL_UNPACK_COMPRESSED_BLOCK_HEIGHT, GL_UNPACK_COMPRESSED_BLOCK_DEPTH, GL_UNPACK_COMPRESSED_BLOCK_SIZE>;

    /// Given back in this order: what a write changes besides comes after it.
    using Pieces = std::tuple<
        Piece<piece::Program>, Piece<piece::Subroutines>, Piece<piece::VertexArray>,
        Piece<piece::Framebuffer>, Piece<piece::TextureAt, slots * piece::TextureAt::targets>,
        Piece<piece::SamplerAt, slots>, Piece<piece::ActiveTexture>, Piece<piece::ImageAt, slots>,
        Piece<piece::StorageAt, slots>, Piece<piece::StorageBuffer>, Piece<piece::UniformAt, slots>,
        Piece<piece::UniformBuffer>, Piece<piece::DrawIndirectBuffer>, Piece<piece::DispatchIndirectBuffer>,
        Piece<piece::PackBuffer>, Piece<piece::UnpackBuffer>, Piece<piece::QueryBuffer>,
        Piece<piece::PixelStore<GL_PACK_ALIGNMENT>>, Piece<piece::PixelStore<GL_UNPACK_ALIGNMENT>>,
        Piece<piece::Enabled<GL_TEXTURE_CUBE_MAP_SEAMLESS>>, Piece<piece::Enabled<GL_FRAMEBUFFER_SRGB>>,
        Piece<piece::Enabled<GL_PROGRAM_POINT_SIZE>>, Piece<piece::Enabled<GL_MULTISAMPLE>>,
        Piece<piece::ClipControl>, Piece<piece::FrontFace>, Piece<piece::ProvokingVertex>,
        Piece<piece::PolygonMode>, Piece<piece::LineWidth>, Piece<piece::PointFade>,
        Piece<piece::PointOrigin>, Piece<piece::ViewportBox>, Piece<piece::DepthRange>,
        Piece<piece::ScissorBox>, Piece<piece::EnabledAt<GL_SCISSOR_TEST>>,
        Piece<piece::Enabled<GL_DEPTH_TEST>>, Piece<piece::Enabled<GL_DEPTH_CLAMP>>,
        Piece<piece::DepthFunction>, Piece<piece::DepthMask>, Piece<piece::Enabled<GL_POLYGON_OFFSET_FILL>>,
        Piece<piece::PolygonOffset>, Piece<piece::Enabled<GL_CULL_FACE>>, Piece<piece::CullFace>,
        Piece<piece::ColorMask, color_targets>, Piece<piece::EnabledAt<GL_BLEND>, color_targets>,
        Piece<piece::BlendFunction, color_targets>, Piece<piece::BlendEquation, color_targets>>;

    template <class Kind, size_t count = 1>
    bool set(const typename Kind::Value& value, GLuint index = 0) {
        return std::get<Piece<Kind, count>>(pieces_).set(value, borrowed_, index);
    }
    template <class Kind, size_t count = 1>
    void disturb(GLuint index = 0) {
        std::get<Piece<Kind, count>>(pieces_).disturb(borrowed_, index);
    }
    template <class Kind, size_t count = 1>
    bool knows(const typename Kind::Value& value, GLuint index) const {
        return std::get<Piece<Kind, count>>(pieces_).knows(value, index);
    }
    template <class... Each>
    void set_all(std::tuple<Each...>& pieces, const auto& value) {
        std::apply([&](auto&... each) { (each.set(value, borrowed_), ...); }, pieces);
    }
    template <class Visit>
    void visit_all(Visit visit) {
        const auto each = [&](auto&... pieces) { (visit(pieces), ...); };
        std::apply(each, pieces_);
        std::apply(each, unused_);
        std::apply(each, packing_);
        std::apply(each, unpacking_);
    }

    void color_target(GLuint target, const rhi::ColorTargetState& state);
    void depth(const std::optional<rhi::DepthState>& depth);
    void color_masks(GLuint target, uint8_t bits);
    void scissor(bool on) { set<piece::EnabledAt<GL_SCISSOR_TEST>>(on); }

    bool borrowed_;
    Pieces pieces_;
    Unused unused_;
    Packing packing_;
    Unpacking unpacking_;
    std::optional<rhi::RasterState> raster_;  ///< the last, while all of it is known to hold
};

}  // namespace lumo::backends::gl
