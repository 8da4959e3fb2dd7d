#include "techniques/frame/settings.hpp"

#include <algorithm>
#include <array>

namespace lumo::frame {
namespace {

constexpr std::array<std::string_view, layer_count> layer_names = {
    "final", "radiance", "direct", "indirect", "irradiance", "specular",
    "ao",    "emission", "albedo", "normal",   "depth",      "voxels"};

}  // namespace

std::string_view to_string(Layer layer) { return layer_names[size_t(layer)]; }

std::optional<Layer> layer_from_string(std::string_view name) {
    const auto found = std::find(layer_names.begin(), layer_names.end(), name);
    if (found == layer_names.end()) return std::nullopt;
    return Layer(found - layer_names.begin());
}

bool Settings::wants(Layer layer) const {
    return std::find(layers.begin(), layers.end(), layer) != layers.end();
}

}  // namespace lumo::frame
