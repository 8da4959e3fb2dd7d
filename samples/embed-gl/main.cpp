// An OpenGL program of another making that lets lumo light its scene: porting.md in docs/ walks through it. host.* is
// the program as it was, gi.* what lumo adds.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <functional>
#include <optional>
#include <stdexcept>

#include "samples/embed-gl/context.hpp"
#include "samples/embed-gl/gi.hpp"
#include "samples/embed-gl/host.hpp"
#include "samples/embed-gl/state_dump.hpp"
#include "scene/image.hpp"

using namespace embed;

namespace {

struct Options {
    std::string output = {};
    bool indirect = true;
    bool check_state = false;
    uint64_t frames = 0;
    ContextDesc context;
};

/// Does what lumo does, and where asked compares all of OpenGL's state before and after.
class Guard {
  public:
    explicit Guard(bool on) : on_(on) {}
    void run(const char* what, const std::function<void()>& lumo) {
        if (!on_) return lumo();
        const StateDump before = dump_state();
        lumo();
        for (const std::string& line : differences(before, dump_state())) {
            std::fprintf(stderr, "embed-gl: %s: %s\n", what, line.c_str());
            found_ = true;
        }
        compared_ = before.size();
    }
    void report() const {
        if (found_) throw std::runtime_error("lumo changed the host's state");
        if (on_) std::printf("%zu values of the host's state are as they were\n", compared_);
    }

  private:
    bool on_;
    bool found_ = false;
    size_t compared_ = 0;
};

void save(const Host& host, const std::string& file) {
    const std::vector<uint8_t> texels = host.read_picture();
    lumo::scene::Image8 image{uint32_t(host.width()), uint32_t(host.height()), 4,
                              std::vector<uint8_t>(texels.size())};
    for (uint32_t y = 0; y < image.height; ++y)  // files begin at the top
        std::copy_n(texels.data() + image.offset(0, image.height - 1 - y), size_t(image.width) * 4,
                    image.at(0, y));
    if (auto written = lumo::scene::write_png(file, image); !written)
        throw std::runtime_error(to_string(written.error()));
}

void run(const Options& options) {
    const Context context(options.context);
    Host host(options.context.width, options.context.height);
    Guard guard(options.check_state);
    const Camera camera;
    std::optional<Gi> gi;

    const uint64_t frames = options.context.headless ? std::max<uint64_t>(options.frames, 1) : options.frames;
    for (uint64_t i = 0; !context.should_close() && (frames == 0 || i < frames); ++i) {
        host.draw_surfaces(camera);
        if (options.indirect && !gi) guard.run("making", [&] { gi.emplace(host); });
        if (gi) guard.run("a frame", [&] { gi->record(camera); });
        host.compose(camera, gi.has_value());
        if (!options.context.headless) host.show();
        context.swap();
    }
    if (!options.output.empty()) save(host, options.output);
    if (gi) guard.run("leaving", [&] { gi.reset(); });
    guard.report();
    if (host.messages() > 0) throw std::runtime_error("the driver objected");
}

}  // namespace

int main(int argc, char** argv) {
    Options options;
    CLI::App app{"An OpenGL program of another making that lets lumo light its scene."};
    app.add_flag("--headless", options.context.headless, "no window");
    app.add_flag("--egl", options.context.egl, "the window's context is made by EGL");
    app.add_option("-o,--output", options.output, "a PNG file for the last frame");
    app.add_flag("!--no-gi", options.indirect, "without lumo");
    app.add_option("--frames", options.frames, "end after so many");
    app.add_option("--width", options.context.width, "pixels")->check(CLI::Range(16, 4096));
    app.add_option("--height", options.context.height, "pixels")->check(CLI::Range(16, 4096));
    app.add_flag("--check-state", options.check_state, "compare all of OpenGL's state before and after lumo");
    CLI11_PARSE(app, argc, argv);
    try {
        run(options);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "embed-gl: %s\n", error.what());
        return 1;
    }
    return 0;
}
