#include "techniques/post/post.hpp"

#include <array>
#include <cmath>
#include <fmt/format.h>

namespace lumo::post {

using rhi::Dimension;

namespace {
constexpr std::array<std::string_view, tonemap_count> names{"none", "reinhard", "hable", "aces", "agx"};
}

std::string_view to_string(Tonemap tonemap) { return names[size_t(tonemap)]; }

std::optional<Tonemap> tonemap_from_string(std::string_view name) {
    for (size_t i = 0; i < names.size(); ++i)
        if (names[i] == name) return Tonemap(i);
    return {};
}

Result<Post> Post::create(rhi::Device& device, const Settings& settings, rhi::Extent size) {
    if (!(std::abs(settings.exposure) <= 64))
        return fail(ErrorKind::invalid_argument, "exposure", fmt::format("{} stops", settings.exposure),
                    "choose -64 to 64");
    Post made;
    made.settings_ = settings;
    return device
        .create_texture({.name = "post.display",
                         .format = rhi::Format::rgba8_unorm,
                         .extent = size,
                         .usage = rhi::TextureUsage::sampled | rhi::TextureUsage::storage})
        .and_then([&](rhi::Texture texture) {
            made.display_ = std::move(texture);
            return device.create_sampler(
                {.magnification = rhi::FilterMode::nearest, .minification = rhi::FilterMode::nearest});
        })
        .and_then([&](rhi::Sampler sampler) {
            made.sampler_ = std::move(sampler);
            return device.create_compute_pipeline<shaders::post::display>(
                {.tonemap = int32_t(settings.tonemap)});
        })
        .map([&](rhi::ComputePipeline<shaders::post::display> pipeline) {
            made.pipeline_ = std::move(pipeline);
            return std::move(made);
        });
}

rhi::View<Dimension::d2> Post::record(rhi::Commands& commands, rhi::View<Dimension::d2> radiance) {
    const rhi::Extent size = display_.desc().extent;
    rhi::Pass pass = commands.pass("post.display");
    pass.dispatch(pipeline_, {{radiance, sampler_}, display_.view<Dimension::d2>()},
                  {.exposure = std::exp2(settings_.exposure)}, rhi::groups_for(size, {8, 8}));
    return display_.view<Dimension::d2>();
}

}  // namespace lumo::post
