// From radiance to a picture: exposure, tone curve, sRGB encoding.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "rhi/rhi.hpp"
#include "shaders/post/display.hpp"

namespace lumo::post {

/// Curves and their sources: shaders/post/tone_curves.glsl. `none` clips at 1.
enum class Tonemap : uint8_t { none, reinhard, hable, aces, agx };
inline constexpr int tonemap_count = int(Tonemap::agx) + 1;

std::string_view to_string(Tonemap tonemap);
std::optional<Tonemap> tonemap_from_string(std::string_view name);

struct Settings {
    float exposure = 0;  ///< stops: radiance is multiplied by 2 to this, then 1 W/m²/sr is white; -64 to 64
    Tonemap tonemap = Tonemap::none;
};

class Post {
  public:
    /// Errors: those of the device; invalid_argument for an exposure outside its range.
    static Result<Post> create(rhi::Device& device, const Settings& settings, rhi::Extent size);

    /// Returns rgba8_unorm that holds sRGB values; alpha is 1. `radiance` has the size given to create.
    rhi::View<rhi::Dimension::d2> record(rhi::Commands& commands, rhi::View<rhi::Dimension::d2> radiance);

    /// The picture, to read it back.
    const rhi::Texture& display() const { return display_; }

  private:
    Settings settings_;
    rhi::Texture display_;
    rhi::Sampler sampler_;
    rhi::ComputePipeline<shaders::post::display> pipeline_;
};

}  // namespace lumo::post
