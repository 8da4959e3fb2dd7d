#include "samples/lumo/pictures.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <iterator>

#include "samples/lumo/names.hpp"
#include "scene/printable.hpp"

namespace lumo::program {
namespace {

scene::ImageF over_255(const scene::Image8& image) {
    scene::ImageF result{image.width, image.height, image.channels, {}};
    result.values.reserve(image.values.size());
    std::ranges::transform(image.values, std::back_inserter(result.values),
                           [](uint8_t value) { return float(value) / 255; });
    return result;
}

scene::Image8 times_255(const scene::ImageF& image) {
    scene::Image8 result{image.width, image.height, image.channels, {}};
    result.values.reserve(image.values.size());
    std::ranges::transform(image.values, std::back_inserter(result.values), [](float value) {
        return uint8_t(std::lround(255 * std::clamp(value, 0.0f, 1.0f)));
    });
    return result;
}

scene::ImageF absolute_difference(const scene::ImageF& a, const scene::ImageF& b) {
    scene::ImageF result = a;
    for (size_t i = 0; i < result.values.size(); ++i) result.values[i] = std::abs(a.values[i] - b.values[i]);
    return result;
}

reference::ParityRule rule_of(ParityChoice choice, bool display) {
    if (choice == ParityChoice::mesa) return display ? reference::mesa_png_parity : reference::mesa_parity;
    return display ? reference::hardware_png_parity : reference::hardware_parity;
}

std::string layer_names(const Picture& picture) {
    std::vector<std::string> names;
    for (const scene::ExrLayer& layer : picture.layers)
        names.push_back(layer.name.empty() ? "plain channels" : scene::printable(layer.name));
    return fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace

Result<Picture> read_picture(const std::filesystem::path& file) {
    const std::string extension = extension_of(file);
    if (extension == ".exr") {
        return scene::read_exr(file).map(
            [](std::vector<scene::ExrLayer> layers) { return Picture{.layers = std::move(layers)}; });
    }
    const bool display = extension != ".hdr";
    return scene::read_image_float(file).map([&](scene::ImageF image) {
        return Picture{.display = display, .layers = {{.image = std::move(image)}}};
    });
}

Result<void> write_picture(const std::filesystem::path& file, const Picture& picture) {
    if (picture.display) return scene::write_png(file, times_255(picture.layers.front().image));
    return scene::write_exr(file, picture.layers);
}

Picture picture_of(const std::vector<frame::LayerImage>& layers, const std::vector<std::string>& names) {
    if (layers.front().layer == frame::Layer::final)
        return {.display = true, .layers = {{.image = over_255(layers.front().display)}}};
    Picture picture;
    for (size_t i = 0; i < layers.size(); ++i)
        picture.layers.push_back({.name = names[i], .image = layers[i].linear});
    return picture;
}

Result<std::vector<LayerComparison>> compare(const Picture& a, const Picture& b, ParityChoice rule,
                                             const std::string& subject) {
    if (a.display != b.display)
        return fail(ErrorKind::invalid_argument, subject, "one is display-referred and one is linear",
                    "compare .png with .png, .exr with .exr");
    if (!std::ranges::equal(a.layers, b.layers, {}, &scene::ExrLayer::name, &scene::ExrLayer::name))
        return fail(ErrorKind::invalid_argument, subject,
                    fmt::format("layers differ: {}; {}", layer_names(a), layer_names(b)),
                    "compare pictures with the same layers");
    std::vector<LayerComparison> all;
    for (size_t i = 0; i < a.layers.size(); ++i) {
        auto figures =
            reference::compare(a.layers[i].image, b.layers[i].image,
                               {.parity_rule = rule_of(rule, a.display), .encoded_srgb = a.display});
        if (!figures) {
            figures.error().subject = subject;
            return tl::unexpected(figures.error());
        }
        all.push_back({.layer = a.layers[i].name, .figures = std::move(*figures)});
    }
    return all;
}

Result<void> write_difference(const std::filesystem::path& file, const Picture& a, const Picture& b) {
    Picture difference{.display = extension_of(file) == ".png"};
    if (difference.display) {
        auto picture = reference::difference_picture(a.layers.front().image, b.layers.front().image);
        if (!picture) return tl::unexpected(picture.error());
        difference.layers.push_back({.image = std::move(*picture)});
    } else {
        for (size_t i = 0; i < a.layers.size(); ++i)
            difference.layers.push_back(
                {a.layers[i].name, absolute_difference(a.layers[i].image, b.layers[i].image)});
    }
    return write_picture(file, difference);
}

Result<void> check_output(const std::filesystem::path& file) {
    const std::string name = scene::printable(file.string());
    const std::string extension = extension_of(file);
    if (extension != ".png" && extension != ".exr")
        return fail(ErrorKind::invalid_argument, name, "is neither .png nor .exr", "give one of these");
    std::error_code ignored;
    const std::filesystem::path folder = file.parent_path();
    if (!folder.empty() && !std::filesystem::is_directory(folder, ignored))
        return fail(ErrorKind::io, name, "its folder does not exist",
                    "make it: mkdir -p " + scene::printable(folder.string()));
    return {};
}

}  // namespace lumo::program
