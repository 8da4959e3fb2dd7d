#include "techniques/cones/specular.hpp"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/packing.hpp>
#include <span>

#include "rhi/keep.hpp"

namespace lumo::cones {
namespace {

using rhi::Dimension;

constexpr uint32_t table_side = 32;

/// By half vectors drawn from the GGX distribution (Walter et al. 2007) at the midpoints of a grid. The BRDF over
/// the density of the reflected direction is the visibility times 4 v·h / n·h.
glm::dvec2 reflectance_at(double n_v, double roughness) {
    constexpr int samples = 32;
    const double alpha = roughness * roughness;
    const double k = (roughness + 1) * (roughness + 1) / 8;
    const glm::dvec3 view(std::sqrt(1 - n_v * n_v), 0, n_v);
    glm::dvec2 sum(0);
    for (int i = 0; i < samples; ++i) {
        const double part = (i + 0.5) / samples;
        const double cosine = std::sqrt((1 - part) / (1 + (alpha * alpha - 1) * part));
        const double sine = std::sqrt(1 - cosine * cosine);
        for (int j = 0; j < samples; ++j) {
            const double azimuth = glm::pi<double>() * (j + 0.5) / samples;  // the other half mirrors it
            const glm::dvec3 half(sine * std::cos(azimuth), sine * std::sin(azimuth), cosine);
            const double v_h = glm::dot(view, half);
            const double n_l = 2 * v_h * half.z - n_v;
            if (v_h <= 0 || n_l <= 0) continue;
            const double visibility = 0.25 / ((n_l * (1 - k) + k) * (n_v * (1 - k) + k));
            const double reflected = visibility * n_l * 4 * v_h / half.z;
            const double fresnel = std::pow(1 - v_h, 5);
            sum += glm::dvec2(1 - fresnel, fresnel) * reflected;
        }
    }
    return sum / double(samples * samples);
}

}  // namespace

std::vector<glm::vec2> specular_reflectance(uint32_t side) {
    constexpr double min_roughness = 0.045;  // of shaders/common/brdf.glsl
    const double last = side - 1;
    std::vector<glm::vec2> table;
    for (uint32_t y = 0; y < side; ++y)
        for (uint32_t x = 0; x < side; ++x)
            table.emplace_back(reflectance_at(std::max(x / last, 1e-3), std::max(y / last, min_roughness)));
    return table;
}

Result<Specular> Specular::create(rhi::Device& device, const Needs& needs, rhi::Extent size) {
    Specular made;
    made.size_ = size;
    return device
        .create_texture({.name = "cones.specular",
                         .format = rhi::Format::rgba32_float,
                         .extent = size,
                         .usage = rhi::TextureUsage::sampled | rhi::TextureUsage::storage})
        .map(keep(made.specular_))
        .and_then([&] {
            return device
                .create_texture({.name = "cones.specular_reflectance",
                                 .format = rhi::Format::rg16_float,
                                 .extent = {table_side, table_side}})
                .map(keep(made.reflectance_));
        })
        .and_then([&] {
            std::vector<uint32_t> halves;
            for (const glm::vec2& factors : specular_reflectance(table_side))
                halves.push_back(glm::packHalf2x16(factors));
            return device.upload(made.reflectance_, rhi::whole_mip(made.reflectance_.desc()),
                                 std::as_bytes(std::span(halves)));
        })
        .and_then([&] {
            return device
                .create_sampler(
                    {.magnification = rhi::FilterMode::nearest, .minification = rhi::FilterMode::nearest})
                .map(keep(made.point_sampler_));
        })
        .and_then([&] { return device.create_sampler({}).map(keep(made.linear_sampler_)); })
        .and_then([&] {
            return device
                .create_compute_pipeline<shaders::cones::specular>({.gather_emission = needs.emission,
                                                                    .gather_environment = needs.environment,
                                                                    .anisotropic = needs.anisotropic,
                                                                    .octree_levels = needs.octree_levels,
                                                                    .gather_sky = needs.sky})
                .map(keep(made.pipeline_));
        })
        .map([&] { return std::move(made); });
}

rhi::View<Dimension::d2> Specular::record(rhi::Commands& commands, const gbuffer::View& gbuffer,
                                          const Gather& gather, rhi::View<Dimension::d2> irradiance) {
    rhi::Pass pass = commands.pass("cones.specular");
    const auto sampled = [&](rhi::View<Dimension::d2> view) {
        return rhi::Sampled<Dimension::d2>(view, point_sampler_);
    };
    pass.dispatch(pipeline_,
                  {.depth = sampled(gbuffer.depth),
                   .base_color_metallic = sampled(gbuffer.base_color_metallic),
                   .normal_roughness = sampled(gbuffer.normal_roughness),
                   .geometric_normal_occlusion = sampled(gbuffer.geometric_normal_occlusion),
                   .camera = gbuffer.camera,
                   .irradiance = sampled(irradiance),
                   .reflectance = {reflectance_.view<Dimension::d2>(), linear_sampler_},
                   .specular = specular_.view<Dimension::d2>(),
                   .voxel_radiance = gather.radiance,
                   .voxel_radiance_directions = gather.radiance_directions,
                   .voxel_emission = gather.emission,
                   .voxel_emission_directions = gather.emission_directions,
                   .gather = gather.block,
                   .emitters = gather.emitters,
                   .sky_map = gather.sky,
                   .voxel_nodes = gather.nodes},
                  {}, rhi::groups_for(size_, {8, 8}));
    return specular_.view<Dimension::d2>();
}

}  // namespace lumo::cones
