// Questions to the precomputed sky, for tests.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <span>
#include <string>
#include <vector>

#include "reference/atmosphere_light.hpp"
#include "techniques/atmosphere/atmosphere.hpp"
#include "tests/support/device_test.hpp"

namespace lumo::testing_support {

using Answers = std::vector<std::array<float, atmosphere::max_wavelengths>>;

/// Small tables, for what does not depend on how many texels there are.
inline atmosphere::Settings small_sky() {
    return {.iterations = 3,
            .columns = 128,
            .altitudes = 12,
            .suns = 24,
            .directions = 8,
            .degree = 2,
            .zeniths = 12,
            .azimuths = 4,
            .table_nodes = 6};
}

inline Answers ask(rhi::Device& device, const atmosphere::Tables& tables,
                   std::span<const atmosphere::Question> questions) {
    const atmosphere::Probe probe = must(atmosphere::Probe::create(device));
    return must(probe.ask(device, tables, questions));
}

inline Answers ask(rhi::Device& device, const scene::Atmosphere& air, const atmosphere::Settings& settings,
                   std::span<const atmosphere::Question> questions) {
    const atmosphere::Tables tables = must(atmosphere::Tables::create(device, air, settings));
    must(atmosphere::precompute(device, tables));
    return ask(device, tables, questions);
}

inline std::string where(const atmosphere::Question& q) {
    return fmt::format("altitude {} km, view {}, sun {}, azimuth {}, {} km", q.altitude_km, q.view_zenith_deg,
                       q.sun_zenith_deg, q.azimuth_deg, q.distance_km);
}

inline scene::Atmosphere mars() {
    scene::Atmosphere a = scene::earth();
    a.radius_ground_km = 3389.5;
    a.radius_top_km = 3509.5;
    a.rayleigh->scattering_per_km = {1e-4, 2e-4, 5e-4};
    a.rayleigh->scale_height_km = 11;
    a.mie->scattering_per_km = {0.03, 0.027, 0.02};
    a.mie->extinction_per_km = {0.032, 0.033, 0.031};
    a.mie->scale_height_km = 11;
    a.mie->g = 0.65;
    a.ozone.reset();
    return a;
}

inline scene::Atmosphere planet_of_60_km() {
    scene::Atmosphere a = scene::earth();
    a.radius_ground_km = 60;
    a.radius_top_km = 120;
    return a;
}

inline scene::Atmosphere haze(double factor, double scale_height_km = 1.2) {
    scene::Atmosphere a = scene::earth();
    for (double& s : a.mie->scattering_per_km) s *= factor;
    for (double& s : a.mie->extinction_per_km) s *= factor;
    a.mie->scale_height_km = scale_height_km;
    return a;
}

}  // namespace lumo::testing_support
