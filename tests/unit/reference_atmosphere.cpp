// The atmosphere's optical depths and its light, against closed forms and by second methods.
#include <cmath>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <numbers>

#include "reference/atmosphere_light.hpp"

namespace lumo::reference {
namespace {

using scene::earth;

constexpr double pi = std::numbers::pi;

/// One wavelength, molecules alone.
Atmosphere molecules(double scattering_per_km = 0.03) {
    return {.wavelengths_nm = {440},
            .sun_irradiance = {1},
            .rayleigh = scene::RayleighSpecies{.scattering_per_km = {scattering_per_km}},
            .ground_albedo = {0.3}};
}

/// By many trapezoids.
Densities brute_column(const AtmosphereOptics& optics, RayPoint from, double length, int steps) {
    Densities sum;
    for (int i = 0; i <= steps; ++i) {
        const Densities d = optics.densities(optics.along(from, length * i / steps).h);
        const double weight = (i == 0 || i == steps ? 0.5 : 1) * length / steps;
        sum += {.rayleigh = weight * d.rayleigh, .mie = weight * d.mie, .ozone = weight * d.ozone};
    }
    return sum;
}

TEST(AtmosphereOptics, PhaseFunctionsIntegrateToOne) {
    for (const double g : {-0.6, 0.0, 0.5, 0.8, 0.95}) {
        double rayleigh = 0, mie = 0;
        for (int i = 0; i < 2000; ++i) {
            gauss(-1 + i * 1e-3, -1 + (i + 1) * 1e-3, [&](double nu, double weight) {
                rayleigh += 2 * pi * weight * rayleigh_phase(nu);
                mie += 2 * pi * weight * cornette_shanks_phase(nu, g);
            });
        }
        EXPECT_NEAR(rayleigh, 1, 1e-12);
        EXPECT_NEAR(mie, 1, 1e-9) << g;
    }
}

TEST(AtmosphereOptics, VerticalColumnsHaveClosedForms) {
    const AtmosphereOptics optics(earth());
    for (const double h : {0.0, 1e-6, 3.0, 12.0, 30.0}) {
        const Densities c = optics.column({.h = h, .mu = 1}, 60 - h);
        EXPECT_NEAR(c.rayleigh / (8 * (std::exp(-h / 8) - std::exp(-60.0 / 8))), 1, 1e-9) << h;
        EXPECT_NEAR(c.mie / (1.2 * (std::exp(-h / 1.2) - std::exp(-60.0 / 1.2))), 1, 1e-9) << h;
    }
    EXPECT_NEAR(optics.column({.h = 0, .mu = 1}, 60).ozone, 15, 1e-8) << "half of 30 km";
    EXPECT_NEAR(optics.column({.h = 25, .mu = 1}, 35).ozone, 7.5, 1e-8);
    EXPECT_NEAR(optics.column({.h = 25, .mu = -1}, 25).ozone, 7.5, 1e-8);
}

/// Chapman's function at 90 degrees: sqrt(pi X / 2) (1 + 3 / (8 X)) for X = R / H (an isothermal, exponential shell).
TEST(AtmosphereOptics, LevelColumnsAreChapmans) {
    Atmosphere a = earth();
    a.radius_top_km = 6360 + 400;
    const AtmosphereOptics optics(a);
    const auto path = *optics.air_path({.h = 0, .mu = 0});
    const Densities c = optics.column(path.at, path.length);
    for (const auto& [column, scale] : {std::pair{c.rayleigh, 8.0}, std::pair{c.mie, 1.2}}) {
        const double x = 6360 / scale;
        EXPECT_NEAR(column / (scale * std::sqrt(pi * x / 2) * (1 + 3 / (8 * x))), 1, 1e-6);
    }
}

TEST(AtmosphereOptics, SlantedColumnsAreWhatManyTrapezoidsSum) {
    Atmosphere small = earth();
    small.radius_ground_km = 60;
    small.radius_top_km = 120;
    for (const Atmosphere& a : {earth(), small}) {
        const AtmosphereOptics optics(a);
        for (const double h : {0.0, 0.5, 18.0, 60.0}) {
            for (const double degrees : {5.0, 80.0, 89.9, 90.0, 92.0, 97.0, 120.0, 179.0}) {
                const auto path = *optics.air_path({.h = h, .mu = cos_degrees(degrees)});
                const Densities exact = optics.column(path.at, path.length);
                const Densities brute = brute_column(optics, path.at, path.length, 40'000);
                const std::string where = fmt::format("{} km, {} degrees, {} km", h, degrees, path.length);
                EXPECT_NEAR(exact.rayleigh, brute.rayleigh, 2e-6 * brute.rayleigh) << where;
                EXPECT_NEAR(exact.mie, brute.mie, 2e-5 * brute.mie) << where;
                EXPECT_NEAR(exact.ozone, brute.ozone, 2e-5 * brute.ozone + 1e-9) << where;
            }
        }
    }
}

TEST(AtmosphereOptics, TransmittanceIsReciprocalAndMultiplies) {
    const AtmosphereOptics optics(earth());
    for (const double degrees : {20.0, 88.0, 90.0, 91.0}) {
        const RayPoint from{.h = 2, .mu = cos_degrees(degrees)};
        const RayPoint middle = optics.along(from, 40), end = optics.along(from, 100);
        const Spectrum whole = optics.transmittance_segment(from, 100);
        const Spectrum back = optics.transmittance_segment({.h = end.h, .mu = -end.mu}, 100);
        const Spectrum first = optics.transmittance_segment(from, 40);
        const Spectrum second = optics.transmittance_segment(middle, 60);
        for (size_t i = 0; i < 3; ++i) {
            EXPECT_NEAR(whole[i] / back[i], 1, 1e-8) << degrees;
            EXPECT_NEAR(first[i] * second[i] / whole[i], 1, 1e-8) << degrees;
        }
    }
}

TEST(AtmosphereOptics, TheGroundEndsRays) {
    const AtmosphereOptics optics(earth());
    EXPECT_EQ(optics.transmittance_to_space({.h = 2, .mu = -1})[0], 0);
    EXPECT_GT(optics.transmittance_segment({.h = 2, .mu = -1}, 2)[0], 0) << "the ground itself";
    EXPECT_EQ(optics.transmittance_segment({.h = 2, .mu = -1}, 2.001)[0], 0);
    const double horizon = optics.horizon_mu(0.002);
    EXPECT_GT(optics.transmittance_to_space({.h = 0.002, .mu = horizon + 1e-9})[0], 0);
    EXPECT_EQ(optics.transmittance_to_space({.h = 0.002, .mu = horizon - 1e-9})[0], 0);
    EXPECT_GT(optics.transmittance_to_space({.h = 0, .mu = 0})[0], 0) << "along the ground";
    EXPECT_EQ(optics.transmittance_to_space({.h = 10'000, .mu = 0.1})[0], 1) << "past the planet";
    EXPECT_EQ(optics.transmittance_to_space({.h = 60, .mu = 1})[0], 1) << "at the top";
    EXPECT_EQ(optics.transmittance_to_space({.h = 10'000, .mu = -1})[0], 0);
}

TEST(AtmosphereOptics, TheSunSetsByASmoothstep) {
    const AtmosphereOptics optics(earth());
    const double alpha = 0.2678 * pi / 180;
    EXPECT_EQ(optics.sun_visibility(0, alpha), 1);
    EXPECT_NEAR(optics.sun_visibility(0, alpha / 2), 0.84375, 1e-12);
    EXPECT_EQ(optics.sun_visibility(0, 0), 0.5);
    EXPECT_EQ(optics.sun_visibility(0, -alpha), 0);
    EXPECT_NEAR(optics.sun_visibility(100, optics.horizon_mu(100) + alpha / 2 * 6360 / 6460), 0.84375, 1e-9);
    EXPECT_NEAR(optics.sun_irradiance(0, 0.5)[1], 1.8504 * 0.5 * optics.transmittance_to_space({0, 0.5})[1],
                1e-12);
}

TEST(AtmosphereLight, NothingScattersNothing) {
    Atmosphere a = earth();
    a.rayleigh.reset();
    a.mie.reset();
    const AtmosphereOptics optics(a);
    const SkyView view{.view_zenith_deg = 70, .sun_zenith_deg = 30};
    EXPECT_THAT(radiance_order1(optics, view), testing::Each(0.0));
    EXPECT_THAT(radiance(optics, view, {.samples = 50}).mean, testing::Each(0.0));
    EXPECT_THAT(sky_irradiance(optics, view, {.first_order = 1, .samples = 50}).mean, testing::Each(0.0));
    a.ozone.reset();
    EXPECT_THAT(AtmosphereOptics(a).transmittance_to_space({.h = 0, .mu = 0.3}), testing::Each(1.0));
}

/// With sun and view overhead and g = 0, order 1 of one species that scatters alone, flat, is
/// phase · E · (1 - exp(-2 tau)) / 2 seen from above, and phase · E · tau · exp(-tau) from below.
TEST(AtmosphereLight, Order1OverheadHasClosedForms) {
    const AtmosphereOptics optics(molecules());
    const double tau = optics.extinction(optics.column({.h = 0, .mu = 1}, 60), 0);
    const double below = radiance_order1(optics, {.view_zenith_deg = 0, .sun_zenith_deg = 0})[0];
    EXPECT_NEAR(below / (rayleigh_phase(1) * tau * std::exp(-tau)), 1, 1e-7);
    const double above =
        radiance_order1(optics, {.altitude_km = 300, .view_zenith_deg = 180, .sun_zenith_deg = 0})[0];
    EXPECT_NEAR(above / (rayleigh_phase(-1) * (1 - std::exp(-2 * tau)) / 2), 1, 1e-7);
}

TEST(AtmosphereLight, Order1IsWhatManyTrapezoidsSum) {
    const AtmosphereOptics optics(earth());
    const Atmosphere& a = optics.atmosphere();
    for (const SkyView& view :
         {SkyView{0, 30, 50, 40}, SkyView{0, 89.5, 80, 0}, SkyView{0, 90, 92, 10}, SkyView{8, 93, 88, 170},
          SkyView{400, 109.5, 95, 0}, SkyView{2, 80, 70, 0, 20}}) {
        const double mu = cos_degrees(view.view_zenith_deg);
        const auto path = *optics.air_path({.h = view.altitude_km, .mu = mu});
        const double length = std::min(path.length, view.distance_km - path.entry);
        const double sines = cos_degrees(90 - view.view_zenith_deg) * cos_degrees(90 - view.sun_zenith_deg);
        const double nu = sines * cos_degrees(view.azimuth_deg) + mu * cos_degrees(view.sun_zenith_deg);
        constexpr int steps = 8000;
        Spectrum brute(3, 0);
        for (int k = 0; k <= steps; ++k) {
            const double d = length * k / steps;
            const RayPoint at = optics.along(path.at, d);
            const double r = optics.radius(view.altitude_km);
            const double mu_sun =
                (r * cos_degrees(view.sun_zenith_deg) + nu * (path.entry + d)) / optics.radius(at.h);
            const Densities local = optics.densities(at.h);
            const Spectrum view_part = optics.transmittance(optics.column(path.at, d));
            const Spectrum sun_part = optics.transmittance(optics.sun_column(at.h, mu_sun));
            const double weight =
                (k == 0 || k == steps ? 0.5 : 1) * length / steps * optics.sun_visibility(at.h, mu_sun);
            for (size_t i = 0; i < 3; ++i)
                brute[i] += weight * view_part[i] * sun_part[i] * a.sun_irradiance[i] *
                            (a.rayleigh->scattering_per_km[i] * local.rayleigh * rayleigh_phase(nu) +
                             a.mie->scattering_per_km[i] * local.mie * cornette_shanks_phase(nu, a.mie->g));
        }
        const Spectrum exact = radiance_order1(optics, view);
        for (size_t i = 0; i < 3; ++i)
            EXPECT_NEAR(exact[i] / brute[i], 1, 1e-4) << view.altitude_km << " km, " << view.view_zenith_deg;
    }
}

TEST(AtmosphereLight, PathsOfOrder1AgreeWithQuadrature) {
    Atmosphere thick = earth();
    for (double& s : thick.mie->scattering_per_km) s *= 50;
    for (double& s : thick.mie->extinction_per_km) s *= 50;
    for (const Atmosphere& a : {earth(), thick}) {
        const AtmosphereOptics optics(a);
        for (const SkyView& view : {SkyView{0, 30, 50, 40}, SkyView{0, 89, 85, 0}, SkyView{8, 95, 60, 170},
                                    SkyView{400, 109.5, 80, 0}, SkyView{0, 90, 70, 0, 15}}) {
            const Spectrum exact = radiance_order1(optics, view);
            const Estimate paths =
                radiance(optics, view, {.first_order = 1, .last_order = 1, .samples = 20'000});
            for (size_t i = 0; i < 3; ++i) {
                EXPECT_NEAR(paths.mean[i], exact[i], 4 * paths.error[i])
                    << view.altitude_km << ' ' << view.view_zenith_deg;
                EXPECT_LT(paths.error[i], 0.02 * exact[i]) << view.altitude_km << ' ' << view.view_zenith_deg;
            }
        }
    }
}

/// Order 2 by nested quadrature: along the ray, over the sphere of directions at each point, order 1 in each.
TEST(AtmosphereLight, PathsOfOrder2AgreeWithNestedQuadrature) {
    const AtmosphereOptics optics(molecules());
    const double zenith = 60, sun_zenith = 50;
    const RayPoint start{.h = 0, .mu = cos_degrees(zenith)};
    const double sun_mu = cos_degrees(sun_zenith), length = optics.air_path(start)->length;
    const auto spread = [](double mu) { return std::sqrt(1 - mu * mu); };
    const double nu = start.mu * sun_mu + spread(start.mu) * spread(sun_mu);
    const auto degrees = [](double cosine) { return std::acos(cosine) * 180 / pi; };

    double order2 = 0;
    for (const auto& [from, to] : {std::pair{0.0, 0.25 * length}, std::pair{0.25 * length, length}}) {
        gauss(from, to, [&](double d, double along_weight) {
            // The view lies in the plane of the sun, and so does the vertical at each of its points.
            const RayPoint at = optics.along(start, d);
            const double there = (optics.radius(0) * sun_mu + nu * d) / optics.radius(at.h);
            double gathered = 0;
            const double horizon = optics.horizon_mu(at.h);
            for (const auto& [low, high] :
                 {std::pair{-1.0, horizon}, std::pair{horizon, 0.25}, std::pair{0.25, 1.0}}) {
                gauss(low, high, [&](double mu, double mu_weight) {
                    constexpr int azimuths = 8;
                    for (int k = 0; k < azimuths; ++k) {
                        const double azimuth = 180 * (k + 0.5) / azimuths;
                        SkyView inner{at.h, degrees(mu), degrees(there), azimuth};
                        double light = radiance_order1(optics, inner, 1e-3)[0];
                        if (const auto path = *optics.air_path({.h = at.h, .mu = mu}); path.ground) {
                            const double to_sun =
                                mu * there + spread(mu) * spread(there) * cos_degrees(azimuth);
                            const double ground_mu =
                                (optics.radius(at.h) * there + to_sun * path.length) / optics.radius(0);
                            light += 0.3 / pi * optics.sun_irradiance(0, ground_mu)[0] *
                                     optics.transmittance(optics.column(path.at, path.length))[0];
                        }
                        const double turn = mu * at.mu + spread(mu) * spread(at.mu) * cos_degrees(azimuth);
                        gathered += mu_weight * 2 * pi / azimuths * rayleigh_phase(turn) * light;
                    }
                });
            }
            order2 += along_weight * optics.scattering(optics.densities(at.h), 0) * gathered *
                      optics.transmittance(optics.column(start, d))[0];
        });
    }
    const Estimate paths =
        radiance(optics, {0, zenith, sun_zenith, 0}, {.last_order = 2, .samples = 150'000});
    EXPECT_NEAR(paths.mean[0] / order2, 1, 3 * paths.error[0] / order2 + 1e-3);
    EXPECT_LT(paths.error[0], 0.004 * order2);
}

TEST(AtmosphereLight, SameSeedSameLight) {
    const AtmosphereOptics optics(earth());
    const SkyView view{0, 40, 60, 0};
    const Estimate a = radiance(optics, view, {.samples = 200, .seed = 7});
    EXPECT_EQ(a.mean, radiance(optics, view, {.samples = 200, .seed = 7}).mean);
    EXPECT_NE(a.mean, radiance(optics, view, {.samples = 200, .seed = 8}).mean);
}

/// Order 1 of the sky's irradiance is the integral of order 1 of its radiance.
TEST(AtmosphereLight, SkyIrradianceIsTheSkysIntegral) {
    const AtmosphereOptics optics(molecules());
    double sum = 0;
    for (const auto& [low, high] : {std::pair{0.0, 0.2}, std::pair{0.2, 1.0}}) {
        gauss(low, high, [&](double mu, double weight) {
            for (int k = 0; k < 16; ++k)
                sum +=
                    weight * mu * 2 * pi / 16 *
                    radiance_order1(optics, {0, std::acos(mu) * 180 / pi, 40, 180 * (k + 0.5) / 16}, 1e-5)[0];
        });
    }
    const Estimate paths = sky_irradiance(optics, {.sun_zenith_deg = 40},
                                          {.first_order = 1, .last_order = 1, .samples = 40'000});
    EXPECT_NEAR(paths.mean[0], sum, 3 * paths.error[0] + 1e-4 * sum);
    EXPECT_LT(paths.error[0], 0.01 * sum);
}

/// Under uniform light of radiance 1 a conservative atmosphere over white ground looks the same in every direction:
/// what a ray that ends in space collects from suns all over the sky is 1 less what it lets through.
TEST(AtmosphereLight, NothingIsCreatedInAFurnace) {
    Atmosphere a = molecules(0.04);
    a.ground_albedo = {1};
    a.mie = scene::MieSpecies{.scattering_per_km = {0.05}, .extinction_per_km = {0.05}};
    const AtmosphereOptics optics(a);
    for (const auto& [zenith, samples] : {std::pair{20.0, 8u}, std::pair{85.0, 64u}}) {
        double sum = 0;
        constexpr int suns = 80, turns = 32;
        for (int k = 0; k < suns; ++k) {
            const double sun_zenith = std::acos(1 - 2 * (k + 0.5) / suns) * 180 / pi;
            for (int t = 0; t < turns; ++t)
                sum += 4 * pi / (suns * turns) *
                       radiance(optics, {0, zenith, sun_zenith, 180 * (t + 0.5) / turns},
                                {.first_order = 1,
                                 .last_order = all_orders,
                                 .samples = samples,
                                 .seed = uint64_t(k * turns + t)})
                           .mean[0];
        }
        EXPECT_NEAR(sum + optics.transmittance_to_space({.h = 0, .mu = cos_degrees(zenith)})[0], 1, 0.01)
            << zenith;
    }
}

TEST(AtmosphereLight, ExtremesAreFiniteAndNotNegative) {
    Atmosphere mars = earth(), planetoid = earth(), stiff = earth(), thin = earth();
    mars.radius_ground_km = 3389.5;
    mars.radius_top_km = 3509.5;
    planetoid.radius_ground_km = 60;
    planetoid.radius_top_km = 120;
    for (double& s : stiff.mie->scattering_per_km) s *= 50;
    for (double& s : stiff.mie->extinction_per_km) s *= 50;
    for (double& s : stiff.rayleigh->scattering_per_km) s *= 5;
    thin.mie->scale_height_km = 0.1;
    thin.ground_albedo = {0, 0.5, 1};
    for (const Atmosphere& a : {mars, planetoid, stiff, thin}) {
        const AtmosphereOptics optics(a);
        for (const double h : {0.0, 1e-6, 1.0, a.height_km(), 1e4}) {
            const double horizon = std::acos(optics.horizon_mu(h)) * 180 / pi;
            for (const double zenith : {0.0, 90.0, horizon, 180.0}) {
                for (const double sun : {0.0, 90.0, 108.0, 180.0}) {
                    const SkyView view{h, zenith, sun, 0};
                    Spectrum light = radiance_order1(optics, view, 1e-4);
                    const Estimate paths = radiance(optics, view, {.last_order = 4, .samples = 10});
                    light.insert(light.end(), paths.mean.begin(), paths.mean.end());
                    for (const double value : light)
                        EXPECT_TRUE(std::isfinite(value) && value >= 0) << h << ' ' << zenith << ' ' << sun;
                }
            }
        }
    }
}

}  // namespace
}  // namespace lumo::reference
