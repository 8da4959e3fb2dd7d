#include "samples/lumo/values.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <optional>

namespace lumo::program {
namespace {

constexpr uint32_t largest_side = 16384;
constexpr uint32_t smallest_volume = 16, largest_volume = 1024;
constexpr uint32_t most_orders = 1000;
constexpr double largest_exposure = 64;
constexpr double highest_altitude = 1e6;                            // km
constexpr double shortest_distance = 1e-6, longest_distance = 1e9;  // metres

tl::unexpected<Error> expected(std::string_view text, std::string what) {
    return fail(ErrorKind::invalid_argument, fmt::format("'{}'", text), "expected " + std::move(what));
}

std::optional<double> number(std::string_view text) {
    if (text.starts_with('+')) text.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return {};
    return value;
}

std::optional<glm::vec3> vector(std::string_view text) {
    const auto parts = split(text, ',');
    if (parts.size() != 3) return {};
    glm::vec3 value{0};
    for (int i = 0; i < 3; ++i) {
        const auto component = number(parts[size_t(i)]);
        if (!component || std::abs(*component) > 1e30) return {};
        value[i] = float(*component);
    }
    return value;
}

std::optional<uint32_t> integer(std::string_view text) {
    uint32_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size()) return {};
    return value;
}

}  // namespace

std::vector<std::string_view> split(std::string_view text, char separator) {
    std::vector<std::string_view> parts;
    for (size_t begin = 0; begin <= text.size();) {
        const size_t end = std::min(text.find(separator, begin), text.size());
        parts.push_back(text.substr(begin, end - begin));
        begin = end + 1;
    }
    return parts;
}

Result<double> parse_number(std::string_view text) {
    if (const auto value = number(text)) return *value;
    return expected(text, "a number");
}

Result<double> parse_positive(std::string_view text) {
    const auto value = number(text);
    if (!value || *value <= 0) return expected(text, "a number above 0");
    return *value;
}

Result<double> parse_ratio(std::string_view text) {
    const bool percent = text.ends_with('%');
    const auto value = number(percent ? text.substr(0, text.size() - 1) : text);
    if (!value || *value <= 0) return expected(text, "a number above 0, or one with %");
    return percent ? *value / 100 : *value;
}

Result<uint32_t> parse_integer(std::string_view text, uint32_t lowest, uint32_t highest) {
    const auto value = integer(text);
    if (!value || *value < lowest || *value > highest)
        return expected(text, fmt::format("an integer from {} to {}", lowest, highest));
    return *value;
}

Result<rhi::Extent> parse_size(std::string_view text) {
    const auto sides = split(text, 'x');
    const auto width = integer(sides.front());
    const auto height = integer(sides.back());
    const auto fits = [](std::optional<uint32_t> side) {
        return side && *side >= 1 && *side <= largest_side;
    };
    if (sides.size() != 2 || !fits(width) || !fits(height))
        return expected(text, fmt::format("WxH in pixels, 1 to {} each, as 960x540", largest_side));
    return rhi::Extent{*width, *height};
}

Result<uint32_t> parse_voxels(std::string_view text) {
    const auto side = integer(text);
    if (!side || !std::has_single_bit(*side) || *side < smallest_volume || *side > largest_volume)
        return expected(text, fmt::format("a power of two from {} to {}", smallest_volume, largest_volume));
    return *side;
}

Result<CameraChoice> parse_camera(std::string_view text) {
    const auto parts = split(text, ':');
    const auto position = vector(parts.front());
    if (parts.size() != 3 || !position) return CameraChoice(std::string(text));  // a name may hold anything

    const auto target = vector(parts[1]);
    const auto fov = number(parts[2]);
    if (!target || !fov)
        return expected(text, "px,py,pz:tx,ty,tz:FOV, or the name or index of a camera of the scene");
    if (*fov <= 0 || *fov >= 180) return expected(text, "a vertical field of view between 0 and 180 degrees");
    const glm::vec3 axis = *target - *position;
    if (axis == glm::vec3(0)) return expected(text, "a target apart from the position");

    const bool along_y = std::hypot(axis.x, axis.z) <= 1e-6f * std::abs(axis.y);
    return scene::Camera{.name = "command line",
                         .position = *position,
                         .target = *target,
                         .up = along_y ? glm::vec3(0, 0, -1) : glm::vec3(0, 1, 0),
                         .vertical_fov = glm::radians(float(*fov))};
}

Result<Sun> parse_sun(std::string_view text) {
    if (text == "none") return Sun{};
    const auto parts = split(text, ':');
    const auto direction = vector(parts.front());
    const auto irradiance = vector(parts.back());
    if (parts.size() != 2 || !direction || !irradiance)
        return expected(text, "dx,dy,dz:r,g,b (toward the sun; W/m² on a plane facing it) or none");
    if (*direction == glm::vec3(0)) return expected(text, "a direction that is not zero");
    if (std::min({irradiance->r, irradiance->g, irradiance->b}) < 0)
        return expected(text, "irradiance of 0 or more");
    return Sun{.direction_to_sun = glm::vec3(glm::normalize(glm::dvec3(*direction))),
               .irradiance = *irradiance};
}

Result<std::vector<frame::Layer>> parse_layers(std::string_view text) {
    std::vector<frame::Layer> layers;
    for (const std::string_view name : split(text, ',')) {
        const auto layer = frame::layer_from_string(name);
        if (!layer) {
            std::string known;
            for (int i = 0; i < frame::layer_count; ++i)
                known += fmt::format("{}{}", i ? ", " : "", frame::to_string(frame::Layer(i)));
            return fail(ErrorKind::invalid_argument, fmt::format("'{}'", name), "there is no such layer",
                        "available, several by commas: " + known);
        }
        if (std::ranges::find(layers, *layer) != layers.end()) return expected(text, "each layer once");
        layers.push_back(*layer);
    }
    return layers;
}

Result<float> parse_exposure(std::string_view text) {
    const auto stops = number(text);
    if (!stops || std::abs(*stops) > largest_exposure)
        return expected(text, fmt::format("stops from {} to {}", -largest_exposure, largest_exposure));
    return float(*stops);
}

Result<double> parse_altitude(std::string_view text) {
    const auto km = number(text);
    if (!km || *km < 0 || *km > highest_altitude)
        return expected(text, fmt::format("kilometres from 0 to {}", highest_altitude));
    return *km;
}

Result<float> parse_distance(std::string_view text) {
    const auto metres = number(text);
    if (!metres || *metres < shortest_distance || *metres > longest_distance)
        return expected(text, fmt::format("metres from {} to {}", shortest_distance, longest_distance));
    return float(*metres);
}

Result<uint32_t> parse_orders(std::string_view text) {
    if (text == "all") return reference::all_orders;
    const auto orders = integer(text);
    if (!orders || *orders < 1 || *orders > most_orders)
        return expected(text, fmt::format("an integer from 1 to {}, or all", most_orders));
    return *orders;
}

Result<double> parse_part(std::string_view text) {
    const auto part = number(text);
    if (!part || *part < 0 || *part > 1) return expected(text, "a number from 0 to 1");
    return *part;
}

Result<Shard> parse_shard(std::string_view text) {
    const auto parts = split(text, '/');
    const auto index = integer(parts.front());
    const auto count = integer(parts.back());
    if (parts.size() != 2 || !index || !count || *index < 1 || *index > *count)
        return expected(text, "I/N with I from 1 to N, as 2/8");
    return Shard{*index, *count};
}

}  // namespace lumo::program
