// A Vulkan program of another making that lets lumo light its scene: porting.md in docs/ walks through it. host.* is
// the program as it was, gi.* what lumo adds.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <optional>
#include <stdexcept>

#include "samples/embed-vulkan/gi.hpp"
#include "samples/embed-vulkan/host.hpp"
#include "samples/embed-vulkan/window.hpp"
#include "scene/image.hpp"

using namespace embed;

namespace {

struct Options {
    bool headless = false;
    std::string output = {};
    bool indirect = true;
    bool check = false;
    uint64_t frames = 0;
    HostOptions host;
};

void frame(Host& host, Gi* gi) {
    const Camera camera;
    host.draw_gbuffer(camera);
    if (gi) gi->record(camera);
    host.compose(camera, gi != nullptr);
    host.finish();
}

void save(Host& host, const std::string& file) {
    const lumo::scene::Image8 image{host.width(), host.height(), 4, host.read_picture()};
    if (auto written = lumo::scene::write_png(file, image); !written)
        throw std::runtime_error(to_string(written.error()));
}

/// The picture without indirect light, which has to be the same whether lumo was there or not.
void expect_unchanged(Host& host, const std::vector<uint8_t>& before) {
    frame(host, nullptr);
    if (host.read_picture() != before)
        throw std::runtime_error("the host's own picture is another than before lumo came");
    std::puts("the host's own picture is the same as before lumo came");
}

void run(Options& options) {
    std::optional<Window> window;
    if (!options.headless) {
        window.emplace("embed-vulkan", options.host.width, options.host.height);
        options.host.surface_extensions = window->instance_extensions();
    }
    int messages = 0;
    {
        Host host(options.host);
        std::vector<uint8_t> before;
        if (options.check) {
            frame(host, nullptr);
            before = host.read_picture();
        }
        std::optional<Gi> gi;
        if (options.indirect) gi.emplace(host);
        if (window) {
            WindowTarget target(*window, host);
            for (uint64_t i = 0; !window->should_close() && (options.frames == 0 || i < options.frames);
                 ++i) {
                window->poll();
                frame(host, gi ? &*gi : nullptr);
                target.show(host);
            }
        } else {
            for (uint64_t i = 0; i < std::max<uint64_t>(options.frames, 1); ++i)
                frame(host, gi ? &*gi : nullptr);
        }
        if (!options.output.empty()) save(host, options.output);
        gi.reset();
        if (options.check) expect_unchanged(host, before);
        messages = host.messages();
    }
    if (messages > 0) throw std::runtime_error("the validation layers objected");
}

}  // namespace

int main(int argc, char** argv) {
    Options options;
    CLI::App app{"A Vulkan program of another making that lets lumo light its scene."};
    app.add_flag("--headless", options.headless, "no window");
    app.add_option("-o,--output", options.output, "a PNG file for the last frame");
    app.add_flag("!--no-gi", options.indirect, "without lumo");
    app.add_option("--frames", options.frames, "end after so many");
    app.add_option("--width", options.host.width, "pixels")->check(CLI::Range(16, 4096));
    app.add_option("--height", options.host.height, "pixels")->check(CLI::Range(16, 4096));
    app.add_flag("--validation", options.host.validation, "the validation layers; what they say is an error");
    app.add_flag("--check", options.check,
                 "compare the host's own picture before lumo came and after it went");
    CLI11_PARSE(app, argc, argv);
    try {
        run(options);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "embed-vulkan: %s\n", error.what());
        return 1;
    }
    return 0;
}
