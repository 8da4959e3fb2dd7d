#include "reference/environment.hpp"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

namespace lumo::reference {
namespace {

constexpr double pi = glm::pi<double>();

/// In texels of the map, from its corner.
glm::dvec2 place_of(glm::dvec3 direction, size_t columns, size_t rows) {
    const double azimuth = std::atan2(direction.z, direction.x) / (2 * pi);
    const double polar = std::acos(std::clamp(direction.y, -1.0, 1.0)) / pi;
    return {(azimuth - std::floor(azimuth)) * double(columns), polar * double(rows)};
}

}  // namespace

Environment::Environment(const scene::Scene& scene) : scene_(&scene) {
    const scene::ImageF& map = scene.environment_map;
    const auto radiance_of = [&](uint32_t x, uint32_t y) {
        const float* texel = map.at(x, y);
        return double(texel[0]) + double(texel[1]) + double(texel[2]);
    };
    double mean = 0;
    for (uint32_t y = 0; y < map.height; ++y)
        for (uint32_t x = 0; x < map.width; ++x) mean += radiance_of(x, y);
    if (mean <= 0) return;
    columns_ = map.width;
    rows_ = map.height;
    mean /= double(columns_ * rows_);
    // Filtering spreads light into texels that have none: a part is by the mean.
    constexpr double floor = 0.1;
    double sum = 0;
    for (uint32_t y = 0; y < map.height; ++y) {
        for (uint32_t x = 0; x < map.width; ++x) {
            sum += ((1 - floor) * radiance_of(x, y) + floor * mean) * solid_angle(y);
            cumulative_.push_back(sum);
        }
    }
    for (double& value : cumulative_) value /= sum;
}

double Environment::solid_angle(size_t row) const {
    const double top = std::cos(pi * double(row) / double(rows_));
    const double bottom = std::cos(pi * double(row + 1) / double(rows_));
    return (top - bottom) * 2 * pi / double(columns_);
}

glm::dvec3 Environment::radiance(glm::dvec3 direction) const {
    const glm::dvec3 constant(scene_->environment_radiance);
    if (uniform()) return constant;
    const glm::dvec2 place = place_of(direction, columns_, rows_) - 0.5;
    const glm::dvec2 corner = glm::floor(place), part = place - corner;
    glm::dvec3 sum(0);
    for (int i = 0; i < 4; ++i) {
        const int right = i & 1, down = i >> 1;
        const auto x = uint32_t((int64_t(corner.x) + right + int64_t(columns_)) % int64_t(columns_));
        const auto y = uint32_t(std::clamp(int64_t(corner.y) + down, int64_t(0), int64_t(rows_) - 1));
        const float* texel = scene_->environment_map.at(x, y);
        const double weight = (right ? part.x : 1 - part.x) * (down ? part.y : 1 - part.y);
        sum += weight * glm::dvec3(texel[0], texel[1], texel[2]);
    }
    return constant + sum;
}

EnvironmentSample Environment::sample(glm::dvec2 u) const {
    const size_t index = std::min(size_t(std::ranges::upper_bound(cumulative_, u.x) - cumulative_.begin()),
                                  cumulative_.size() - 1);
    const double below = index > 0 ? cumulative_[index - 1] : 0, share = cumulative_[index] - below;
    const size_t row = index / columns_, column = index % columns_;
    // What is left of the first number places the direction within the texel.
    const double across = std::clamp((u.x - below) / share, 0.0, 1.0);
    const double azimuth = 2 * pi * (double(column) + across) / double(columns_);
    const double top = std::cos(pi * double(row) / double(rows_));
    const double bottom = std::cos(pi * double(row + 1) / double(rows_));
    const double height = glm::mix(top, bottom, u.y);
    const double sine = std::sqrt(std::max(1 - height * height, 0.0));
    return {.direction = {sine * std::cos(azimuth), height, sine * std::sin(azimuth)},
            .density = share / solid_angle(row)};
}

double Environment::density(glm::dvec3 direction) const {
    if (uniform()) return 0;
    const glm::dvec2 place = place_of(direction, columns_, rows_);
    const size_t column = std::min(size_t(place.x), columns_ - 1), row = std::min(size_t(place.y), rows_ - 1);
    const size_t index = row * columns_ + column;
    return (cumulative_[index] - (index > 0 ? cumulative_[index - 1] : 0)) / solid_angle(row);
}

}  // namespace lumo::reference
