#include "reference/lights.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lumo::reference {
namespace {

/// The part that a spot light sends in a direction.
double cone(const scene::Light& light, glm::dvec3 from_light) {
    const double outer = std::cos(double(light.outer_cone_angle));
    const double scale = 1 / std::max(1e-3, std::cos(double(light.inner_cone_angle)) - outer);
    const double part =
        std::clamp((glm::dot(glm::dvec3(light.direction), from_light) - outer) * scale, 0.0, 1.0);
    return part * part;
}

double sum_of(glm::dvec3 c) { return c.x + c.y + c.z; }

/// The area of an emitting triangle weighted by its emission, which a texture may vary: the mean over a few points,
/// and a part of what it could be, so that no light between them is never aimed at.
double power_of(const scene::Scene& scene, Hit hit, double area, const scene::Material& material) {
    const double most = sum_of(glm::dvec3(material.emission));
    if (!material.emission_texture) return area * most;
    constexpr int side = 4;
    double sum = 0;
    for (int i = 0; i < side; ++i) {
        for (int j = 0; j < side; ++j) {
            const double root = std::sqrt((i + 0.5) / side);
            hit.weights = {root * (j + 0.5) / side, 1 - root};
            sum += sum_of(emission_at(scene, hit));
        }
    }
    return area * (0.95 * sum / (side * side) + 0.05 * most);
}

}  // namespace

std::optional<Incident> incident(const scene::Light& light, glm::dvec3 position) {
    const glm::dvec3 intensity(light.intensity);
    if (light.kind == scene::LightKind::directional)
        return Incident{.to_light = -glm::normalize(glm::dvec3(light.direction)),
                        .distance = std::numeric_limits<double>::infinity(),
                        .irradiance = intensity};
    const glm::dvec3 to_light = glm::dvec3(light.position) - position;
    const double distance = glm::length(to_light);
    if (distance == 0) return std::nullopt;
    double part = 1 / (distance * distance);
    if (light.range > 0) part *= std::clamp(1 - std::pow(distance / double(light.range), 4), 0.0, 1.0);
    if (light.kind == scene::LightKind::spot) part *= cone(light, -to_light / distance);
    if (part == 0) return std::nullopt;
    return Incident{.to_light = to_light / distance, .distance = distance, .irradiance = intensity * part};
}

Emitters::Emitters(const scene::Scene& scene) : scene_(&scene) {
    double sum = 0;
    for (uint32_t i = 0; i < scene.instances.size(); ++i) {
        const std::vector<scene::Primitive>& primitives = scene.meshes[scene.instances[i].mesh].primitives;
        std::vector<std::optional<size_t>>& first = first_.emplace_back(primitives.size());
        for (uint32_t p = 0; p < primitives.size(); ++p) {
            const scene::Material& material = scene.materials[primitives[p].material];
            if (!material.emits() || material.unlit) continue;
            first[p] = triangles_.size();
            for (uint32_t t = 0; t < primitives[p].index_count / 3; ++t) {
                const Hit hit{.instance = i, .primitive = p, .triangle = t, .weights = {}};
                const Triangle& triangle =
                    triangles_.emplace_back(Triangle{hit, world_triangle(scene, hit), material.double_sided});
                sum += power_of(scene, hit, triangle.area(), material) * (material.double_sided ? 2 : 1);
                cumulative_.push_back(sum);
            }
        }
    }
    if (sum == 0) {
        triangles_.clear();
        first_.clear();
        return;
    }
    for (double& value : cumulative_) value /= sum;
}

double Emitters::probability(size_t triangle) const {
    return cumulative_[triangle] - (triangle > 0 ? cumulative_[triangle - 1] : 0);
}

EmitterSample Emitters::sample(double which, glm::dvec2 u) const {
    const size_t index = std::min(size_t(std::ranges::upper_bound(cumulative_, which) - cumulative_.begin()),
                                  cumulative_.size() - 1);
    const Triangle& triangle = triangles_[index];
    const double root = std::sqrt(u.x);
    Hit hit = triangle.hit;
    hit.weights = {root * u.y, 1 - root};
    const glm::dvec3 weights(1 - hit.weights.x - hit.weights.y, hit.weights);
    const auto& [a, b, c] = triangle.world.corners;
    EmitterSample sample{.position = weights.x * a + weights.y * b + weights.z * c,
                         .normal = glm::normalize(triangle.world.normal),
                         .lift = triangle.world.lift(),
                         .double_sided = triangle.double_sided,
                         .radiance = emission_at(*scene_, hit),
                         .density = probability(index) / triangle.area()};
    const scene::Primitive& primitive =
        scene_->meshes[scene_->instances[hit.instance].mesh].primitives[hit.primitive];
    sample.radiance *= opacity_at(*scene_, primitive, hit.triangle, hit.weights);
    return sample;
}

double Emitters::density(const Hit& hit) const {
    if (empty()) return 0;
    const std::optional<size_t> first = first_[hit.instance][hit.primitive];
    if (!first) return 0;
    const size_t index = *first + hit.triangle;
    const double area = triangles_[index].area();
    return area > 0 ? probability(index) / area : 0;
}

}  // namespace lumo::reference
