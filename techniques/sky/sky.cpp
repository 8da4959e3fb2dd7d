#include "techniques/sky/sky.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <glm/gtc/constants.hpp>

#include "rhi/keep.hpp"
#include "scene/sky.hpp"
#include "techniques/atmosphere/stored.hpp"

namespace lumo::sky {
namespace {

using rhi::Dimension;

constexpr uint32_t map_levels = 5;         // of shaders/sky/map.glsl
constexpr uint32_t samples_of_first = 64;  // cones of level 1; each level has twice as many
constexpr uint32_t group_side = 8;
// Rays that end nearer than this are as good by the fewest nodes of the quadrature; cones are by half of the most.
constexpr float near_metres = 2e3f;
constexpr uint32_t least_nodes = 4, map_nodes = 8;

/// A row for each channel: the weights of up to four wavelengths, from one on.
void set_weights(shaders::sky::map::Sky& block, const std::vector<glm::dvec3>& weights,
                 const scene::Spectrum& sun_irradiance, size_t first, size_t count) {
    const glm::dvec3 sunlight = [&] {
        glm::dvec3 sum(0);
        for (size_t i = 0; i < weights.size(); ++i) sum += weights[i] * sun_irradiance[i];
        return sum;
    }();
    glm::vec4* const radiance[] = {&block.red, &block.green, &block.blue};
    glm::vec4* const transmittance[] = {&block.sunlit_red, &block.sunlit_green, &block.sunlit_blue};
    for (int channel = 0; channel < 3; ++channel) {
        for (size_t i = 0; i < count; ++i) {
            const double weight = weights[first + i][channel];
            (*radiance[channel])[int(i)] = float(weight);
            // Where there is no sun light, all wavelengths count alike.
            (*transmittance[channel])[int(i)] =
                float(sunlight[channel] > 0 ? weight * sun_irradiance[first + i] / sunlight[channel]
                                            : 1.0 / double(weights.size()));
        }
    }
}

/// Hestroffer and Magnan 1998, Wavelength dependency of the Solar limb darkening.
float limb_exponent(double wavelength_nm) {
    return float(std::clamp(-0.023 + 292 / wavelength_nm, 0.1, 1.0));
}

/// shaders/sky/octahedron.glsl.
glm::dvec2 place_of(glm::dvec3 direction) {
    const glm::dvec3 size = glm::abs(direction);
    const glm::dvec2 level = glm::dvec2(direction.x, direction.z) / (size.x + size.y + size.z);
    if (direction.y >= 0) return level;
    return {(1 - std::abs(level.y)) * (level.x < 0 ? -1 : 1),
            (1 - std::abs(level.x)) * (level.y < 0 ? -1 : 1)};
}

}  // namespace

scene::Atmosphere nothing() { return {.wavelengths_nm = {550}, .sun_irradiance = {0}, .ground_albedo = {0}}; }

Settings least_settings() {
    return {.tables = {.orders = 1,
                       .iterations = 2,
                       .columns = 16,
                       .altitudes = 2,
                       .suns = 2,
                       .directions = 4,
                       .degree = 2,
                       .zeniths = 6,
                       .azimuths = 3,
                       .table_nodes = 4,
                       .nodes = 4},
            .map_side = 32};
}

Result<Sky> Sky::create(rhi::Device& device, const scene::Atmosphere& atmosphere, const Settings& settings) {
    if (!std::has_single_bit(settings.map_side) || settings.map_side < 32 || settings.map_side > 2048)
        return fail(ErrorKind::invalid_argument, "sky",
                    fmt::format("a map of {} texels a side", settings.map_side),
                    "give a power of two from 32 to 2048");
    Sky made;
    made.radius_ground_km_ = atmosphere.radius_ground_km;
    const std::vector<glm::dvec3> weights = scene::rgb_weights(atmosphere.wavelengths_nm);
    made.tables_ = settings.made;
    if (!made.tables_) {
        auto tables = atmosphere::stored_or_precomputed_by_fours(device, atmosphere, settings.tables,
                                                                 rhi::DiskCache::of_user());
        if (!tables) return tl::unexpected(tables.error());
        made.tables_ = std::make_shared<const std::vector<atmosphere::Tables>>(std::move(*tables));
    }
    size_t first = 0;
    for (const scene::Atmosphere& four : atmosphere::by_fours(atmosphere)) {
        const size_t count = four.wavelengths_nm.size();
        Block block{};
        set_weights(block, weights, atmosphere.sun_irradiance, first, count);
        for (size_t i = 0; i < count; ++i) block.limb[int(i)] = limb_exponent(four.wavelengths_nm[i]);
        block.sun_radius = float(glm::radians(atmosphere.sun_angular_radius_deg));
        made.parts_.push_back({&(*made.tables_)[made.parts_.size()], block});
        first += count;
    }

    return device
        .create_texture({.name = "sky.map",
                         .dimension = Dimension::d3,
                         .format = rhi::Format::rgba32_float,
                         .extent = {settings.map_side, settings.map_side, 1},
                         .mips = map_levels,
                         .usage = rhi::TextureUsage::sampled | rhi::TextureUsage::storage})
        .map(keep(made.map_))
        .and_then([&] { return device.create_sampler({}).map(keep(made.map_sampler_)); })
        .and_then(
            [&] { return device.create_compute_pipeline<shaders::sky::map>().map(keep(made.map_pipeline_)); })
        .and_then([&] {
            return device.create_compute_pipeline<shaders::sky::cones>().map(keep(made.cones_pipeline_));
        })
        .map([&] { return std::move(made); });
}

Result<void> Sky::create_pixels(rhi::Device& device, rhi::Extent size) {
    const auto make_target = [&](rhi::Texture& target, const char* name) {
        return device
            .create_texture({.name = name,
                             .format = rhi::Format::rgba32_float,
                             .extent = size,
                             .usage = rhi::TextureUsage::sampled | rhi::TextureUsage::storage})
            .map(keep(target));
    };
    return make_target(radiance_, "sky.radiance")
        .and_then([&] { return make_target(transmittance_, "sky.transmittance"); })
        .and_then([&] {
            return device
                .create_sampler(
                    {.magnification = rhi::FilterMode::nearest, .minification = rhi::FilterMode::nearest})
                .map(keep(point_sampler_));
        })
        .and_then([&] {
            return device.create_compute_pipeline<shaders::sky::pixels>().map(keep(pixels_pipeline_));
        });
}

Sky::Block Sky::block(const Part& part, const scene::Sky& sky, glm::vec3 position) const {
    // From the planet's centre, in km: double precision tells centimetres there.
    const glm::dvec3 place =
        glm::dvec3(position) / 1000.0 + glm::dvec3(0, radius_ground_km_ + sky.altitude_km, 0);
    const double radius = glm::length(place);
    Block block = part.weights;
    block.up = radius > 0 ? glm::vec3(place / radius) : glm::vec3(0, 1, 0);
    block.altitude = float(std::max(radius - radius_ground_km_, 0.0));
    block.to_sun = sky.direction_to_sun;
    return block;
}

rhi::Sampled<Dimension::d3> Sky::record_map(rhi::Commands& commands, const scene::Sky& sky) {
    rhi::Pass pass = commands.pass("sky.map");
    const uint32_t side = map_.desc().extent.width;
    for (size_t i = 0; i < parts_.size(); ++i) {
        const atmosphere::Sky tables = parts_[i].tables->sky(commands, map_nodes);
        const uint32_t groups = rhi::groups_for(side, group_side);
        pass.dispatch(map_pipeline_,
                      {.air = tables.block,
                       .air_columns = tables.columns,
                       .air_light = tables.light,
                       .air_peaks = tables.peaks,
                       .sky = commands.uniform(block(parts_[i], sky, glm::vec3(0))),
                       .map = map_.mip<Dimension::d3>(0)},
                      {.add = i > 0}, {groups, groups});
    }
    for (uint32_t level = 1; level < map_levels; ++level) {
        const uint32_t groups = rhi::groups_for(side >> level, group_side);
        pass.dispatch(
            cones_pipeline_,
            {.sky_map = {map_.mip<Dimension::d3>(0), map_sampler_}, .map = map_.mip<Dimension::d3>(level)},
            {.level = int32_t(level), .samples = int32_t(samples_of_first << (level - 1))}, {groups, groups});
    }
    return {map_.view<Dimension::d3>(), map_sampler_};
}

Pixels Sky::record_pixels(rhi::Commands& commands, const gbuffer::View& gbuffer, const scene::Sky& sky,
                          const scene::Camera& camera) {
    Pixels pixels{.radiance = radiance_.view<Dimension::d2>(),
                  .transmittance = transmittance_.view<Dimension::d2>(),
                  .before = {}};
    const bool near = camera.far_plane <= near_metres;
    for (const Part& part : parts_)
        pixels.before.push_back(
            {.tables = part.tables->sky(commands, near ? std::optional(least_nodes) : std::nullopt),
             .view = commands.uniform(block(part, sky, camera.position))});

    rhi::Pass pass = commands.pass("sky.pixels");
    const rhi::Groups groups = rhi::groups_for(gbuffer.size, {group_side, group_side});
    for (size_t i = 0; i < parts_.size(); ++i) {
        for (const bool behind : {true, false}) {
            const atmosphere::Sky tables = behind ? parts_[i].tables->sky(commands) : pixels.before[i].tables;
            pass.dispatch(pixels_pipeline_,
                          {.air = tables.block,
                           .air_columns = tables.columns,
                           .air_light = tables.light,
                           .air_peaks = tables.peaks,
                           .camera = gbuffer.camera,
                           .sky = pixels.before[i].view,
                           .depth = {gbuffer.depth, point_sampler_},
                           .radiance = pixels.radiance,
                           .transmittance = pixels.transmittance},
                          {.add = i > 0, .behind = behind}, groups);
        }
    }
    return pixels;
}

Result<scene::ImageF> download_map(rhi::Device& device, const Sky& sky, uint32_t rows) {
    return device.download(sky.map(), rhi::whole_mip(sky.map().desc()))
        .map([&](const std::vector<std::byte>& bytes) {
            const uint32_t side = sky.map().desc().extent.width;
            const auto texel = [&](uint32_t x, uint32_t y) {
                glm::vec4 value;
                std::memcpy(&value, bytes.data() + (size_t(y) * side + x) * sizeof value, sizeof value);
                return glm::max(glm::dvec3(value), 0.0);
            };
            scene::ImageF image{2 * rows, rows, 3, std::vector<float>(size_t(6) * rows * rows)};
            for (uint32_t y = 0; y < image.height; ++y) {
                for (uint32_t x = 0; x < image.width; ++x) {
                    const double polar = glm::pi<double>() * (y + 0.5) / rows;
                    const double azimuth = glm::pi<double>() * (x + 0.5) / rows;
                    const glm::dvec2 place = place_of({std::sin(polar) * std::cos(azimuth), std::cos(polar),
                                                       std::sin(polar) * std::sin(azimuth)});
                    const glm::dvec2 at = (0.5 + 0.5 * place) * double(side - 1);
                    const glm::uvec2 corner = glm::min(glm::uvec2(at), glm::uvec2(side - 2));
                    const glm::dvec2 part = at - glm::dvec2(corner);
                    const glm::dvec3 value = glm::mix(
                        glm::mix(texel(corner.x, corner.y), texel(corner.x + 1, corner.y), part.x),
                        glm::mix(texel(corner.x, corner.y + 1), texel(corner.x + 1, corner.y + 1), part.x),
                        part.y);
                    for (int c = 0; c < 3; ++c) image.at(x, y)[c] = float(value[c]);
                }
            }
            return image;
        });
}

}  // namespace lumo::sky
