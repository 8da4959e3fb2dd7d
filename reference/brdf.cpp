#include "reference/brdf.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "reference/sampler.hpp"

namespace lumo::reference {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double min_roughness = 0.045;  // as in the shader
constexpr double min_n_v = 1e-4;

double pow5(double x) { return x * x * x * x * x; }

double luminance(glm::dvec3 c) { return glm::dot(c, glm::dvec3(0.2126, 0.7152, 0.0722)); }

// Trowbridge-Reitz; the squared sine by itself keeps the digits of narrow highlights.
double ggx(double alpha, glm::dvec3 half) {
    const double a2 = alpha * alpha;
    const double d = a2 * half.z * half.z + half.x * half.x + half.y * half.y;
    return a2 / (pi * d * d);
}

// Smith's masking of GGX, for the density of visible normals (the BRDF has Schlick's fit instead).
double visible_part(double alpha, double n_v) {
    const double a2 = alpha * alpha;
    return 2 * n_v / (n_v + std::sqrt(a2 + (1 - a2) * n_v * n_v));
}

}  // namespace

Brdf make_brdf(glm::dvec3 base_color, double metallic, double roughness) {
    return {.diffuse = base_color * (1 - metallic),
            .specular = glm::mix(glm::dvec3(0.04), base_color, metallic),
            .roughness = std::max(roughness, min_roughness),
            .lambert = false};
}

Brdf lambertian(glm::dvec3 albedo) {
    return {.diffuse = albedo, .specular = {}, .roughness = 1, .lambert = true};
}

Reflected reflect(const Brdf& brdf, glm::dvec3 to_eye, glm::dvec3 to_light) {
    const double n_l = std::min(to_light.z, 1.0);
    if (n_l <= 0) return {};
    if (brdf.lambert) return {.diffuse = brdf.diffuse / pi * n_l, .specular = {}};
    const double n_v = std::clamp(to_eye.z, min_n_v, 1.0);
    const glm::dvec3 sum = to_eye + to_light;
    const glm::dvec3 half = sum / std::sqrt(std::max(glm::dot(sum, sum), 1e-12));
    const double v_h = std::clamp(glm::dot(to_eye, half), 0.0, 1.0);

    const double grazing = 2 * brdf.roughness * v_h * v_h - 0.5;
    const glm::dvec3 diffuse =
        brdf.diffuse / pi * (1 + grazing * pow5(1 - n_l)) * (1 + grazing * pow5(1 - n_v));
    const double k = (brdf.roughness + 1) * (brdf.roughness + 1) / 8;
    const double visibility = 0.25 / ((n_l * (1 - k) + k) * (n_v * (1 - k) + k));
    const glm::dvec3 fresnel = brdf.specular + (1.0 - brdf.specular) * pow5(1 - v_h);
    const double alpha = brdf.roughness * brdf.roughness;
    return {.diffuse = diffuse * n_l, .specular = ggx(alpha, half) * visibility * fresnel * n_l};
}

DirectionSampler::DirectionSampler(const Brdf& brdf, glm::dvec3 to_eye, double specular_share)
    : to_eye_(glm::normalize(glm::dvec3(to_eye.x, to_eye.y, std::max(to_eye.z, min_n_v)))),
      alpha_(brdf.roughness * brdf.roughness),
      specular_share_(brdf.lambert ? 0 : specular_share) {}

glm::dvec3 DirectionSampler::draw(double lobe, glm::dvec2 u) const {
    if (lobe >= specular_share_) return cosine_direction(u);
    // The ellipsoid of GGX stretched to a sphere; of the disk that is seen, the lower half is foreshortened.
    const glm::dvec3 stretched =
        glm::normalize(glm::dvec3(alpha_ * to_eye_.x, alpha_ * to_eye_.y, to_eye_.z));
    const glm::dmat3 frame = [&] {
        const double squared = stretched.x * stretched.x + stretched.y * stretched.y;
        const glm::dvec3 first =
            squared > 0 ? glm::dvec3(-stretched.y, stretched.x, 0) / std::sqrt(squared) : glm::dvec3(1, 0, 0);
        return glm::dmat3(first, glm::cross(stretched, first), stretched);
    }();
    const double radius = std::sqrt(u.x), angle = 2 * pi * u.y;
    const double x = radius * std::cos(angle);
    const double shown = 0.5 * (1 + stretched.z);
    const double y = (1 - shown) * std::sqrt(1 - x * x) + shown * radius * std::sin(angle);
    const glm::dvec3 normal = frame * glm::dvec3(x, y, std::sqrt(std::max(1 - x * x - y * y, 0.0)));
    const glm::dvec3 half =
        glm::normalize(glm::dvec3(alpha_ * normal.x, alpha_ * normal.y, std::max(normal.z, 1e-9)));
    return 2 * glm::dot(to_eye_, half) * half - to_eye_;
}

double DirectionSampler::density(glm::dvec3 to_light) const {
    if (to_light.z <= 0) return 0;
    const double by_cosine = to_light.z / pi;
    if (specular_share_ == 0) return by_cosine;
    const glm::dvec3 half = glm::normalize(to_eye_ + to_light);
    const double by_normals = visible_part(alpha_, to_eye_.z) * ggx(alpha_, half) / (4 * to_eye_.z);
    return glm::mix(by_cosine, by_normals, specular_share_);
}

double specular_share(const Brdf& brdf, glm::dvec3 to_eye) {
    if (brdf.lambert) return 0;
    const double n_v = std::clamp(to_eye.z, 0.0, 1.0);
    const double specular = luminance(brdf.specular + (1.0 - brdf.specular) * pow5(1 - n_v));
    const double sum = specular + luminance(brdf.diffuse);
    return sum > 0 ? std::clamp(specular / sum, 0.1, 0.9) : 0;
}

}  // namespace lumo::reference
