// A program of its own: a shader of its own fills an image, lumo's post technique makes a picture of it, without a
// window. The picture is held to the sRGB curve.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "backends/backends.hpp"
#include "scene/image.hpp"
#include "shaders/host/ramp.hpp"
#include "techniques/post/post.hpp"

using namespace lumo;

namespace {

template <class T>
T must(Result<T> result) {
    if (!result) throw std::runtime_error(to_string(result.error()));
    if constexpr (!std::is_void_v<T>) return std::move(*result);
}

constexpr uint32_t width = 64;
constexpr float step = 1.0f / 40;  // so that the last third clips

double srgb(double linear) {
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

scene::Image8 picture(rhi::Device& device) {
    const rhi::Extent size{width, 4};
    const auto radiance =
        must(device.create_texture({.name = "radiance",
                                    .format = rhi::Format::rgba32_float,
                                    .extent = size,
                                    .usage = rhi::TextureUsage::sampled | rhi::TextureUsage::storage}));
    auto ramp = must(device.create_compute_pipeline<shaders::host::ramp>());
    auto post = must(post::Post::create(device, {.exposure = 1}, size));
    rhi::Commands commands = device.begin();
    {
        rhi::Pass pass = commands.pass("ramp");
        pass.dispatch(ramp, {.radiance = radiance.view<rhi::Dimension::d2>()}, {.step = step},
                      rhi::groups_for(size, {8, 8}));
    }
    post.record(commands, radiance.view<rhi::Dimension::d2>());
    must(device.wait(device.submit(std::move(commands))));
    const auto bytes = must(device.download(post.display(), rhi::whole_mip(post.display().desc())));
    scene::Image8 image{.width = size.width, .height = size.height, .channels = 4};
    std::ranges::transform(bytes, std::back_inserter(image.values),
                           [](std::byte value) { return std::to_integer<uint8_t>(value); });
    return image;
}

bool follows_the_curve(const scene::Image8& image) {
    for (uint32_t y = 0; y < image.height; ++y)
        for (uint32_t x = 0; x < image.width; ++x) {
            const double expected = 255 * srgb(std::min(2.0 * step * x, 1.0));  // one stop up
            if (std::abs(*image.at(x, y) - expected) > 0.51) return false;
        }
    return true;
}

int run() {
    int devices = 0;
    for (const rhi::Api api : {rhi::Api::vulkan, rhi::Api::gl}) {
        auto device = backends::create_device(api);
        if (!device) {
            std::printf("%s\n", to_string(device.error()).c_str());
            continue;
        }
        ++devices;
        const scene::Image8 image = picture(*device);
        const bool right = follows_the_curve(image);
        std::printf("%s: %s\n", device->info().name.c_str(), right ? "right" : "wrong");
        must(scene::write_png("picture.png", image));
        if (!right) return 1;
    }
    if (devices == 0) std::printf("no device: nothing was drawn\n");
    return 0;
}

}  // namespace

int main() {
    try {
        return run();
    } catch (const std::exception& error) {
        std::fprintf(stderr, "host: %s\n", error.what());
        return 1;
    }
}
