// A window with a triangle: a device, a pipeline, a texture to draw into, and a loop of frames.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <stdexcept>

#include "backends/window.hpp"
#include "scene/image.hpp"
#include "shaders/triangle/draw.hpp"

using namespace lumo;
using lumo::shaders::triangle::draw;

namespace {

/// What lumo makes is a value or an error; here an error ends the program.
template <class T>
T must(Result<T> result) {
    if (!result) throw std::runtime_error(to_string(result.error()));
    if constexpr (!std::is_void_v<T>) return std::move(*result);
}

struct Options {
    std::string api = "vulkan";
    bool vsync = true;
    uint64_t frames = 0;  ///< 0: until the window is closed
    std::string screenshot = {};
};

void save(rhi::Device& device, const rhi::Texture& picture, const std::string& file) {
    const auto [width, height, depth] = picture.desc().extent;
    const std::vector<std::byte> texels = must(device.download(picture, whole_mip(picture.desc())));
    scene::Image8 image{width, height, 4, std::vector<uint8_t>(texels.size())};
    // Row 0 of a texture is the bottom of the picture, of a file its top.
    for (uint32_t y = 0; y < height; ++y)
        std::copy_n(reinterpret_cast<const uint8_t*>(texels.data()) + image.offset(0, height - 1 - y),
                    size_t(width) * 4, image.at(0, y));
    must(scene::write_png(file, image));
}

void run(const Options& options) {
    const rhi::Api api = options.api == "gl" ? rhi::Api::gl : rhi::Api::vulkan;
    auto window = must(backends::Window::open(api, {.title = "lumo: triangle"}));
    auto device = must(window.create_device());

    constexpr auto format = rhi::Format::rgba8_srgb;  // shaders write light, the texture keeps it encoded
    auto pipeline = must(device.create_raster_pipeline<draw>({.color = {{.format = format}}}));
    rhi::Texture picture;

    for (uint64_t frame = 0; !window.should_close() && (options.frames == 0 || frame < options.frames);) {
        window.poll();
        const rhi::Extent size = window.size();
        if (size.width == 0 || size.height == 0) {  // minimised
            window.wait();
            continue;
        }
        if (!picture || picture.desc().extent != size)
            picture = must(device.create_texture({.name = "picture",
                                                  .format = format,
                                                  .extent = size,
                                                  .usage = rhi::TextureUsage::attachment}));

        const auto side = float(std::min(size.width, size.height));
        rhi::Commands commands = device.begin();
        {
            rhi::RasterPass pass = commands.raster_pass(
                "triangle",
                {.color = {{.view = picture.view(), .clear = std::array{0.02f, 0.02f, 0.02f, 1.0f}}}});
            pass.draw(pipeline, {}, {.scale = {side / float(size.width), side / float(size.height)}},
                      rhi::Draw{.vertices = 3});
        }
        commands.present(picture, options.vsync);
        device.submit(std::move(commands));
        ++frame;
    }
    if (!options.screenshot.empty() && picture) save(device, picture, options.screenshot);
}

}  // namespace

int main(int argc, char** argv) {
    Options options;
    CLI::App app{"A window with a triangle."};
    app.add_option("--api", options.api, "vulkan if not given")->check(CLI::IsMember({"vulkan", "gl"}));
    app.add_option("--frames", options.frames, "end after so many");
    app.add_option("--screenshot", options.screenshot, "a PNG file for the last frame");
    app.add_flag("!--no-vsync", options.vsync, "do not wait for the screen");
    CLI11_PARSE(app, argc, argv);
    try {
        run(options);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "triangle: %s\n", error.what());
        return 1;
    }
    return 0;
}
