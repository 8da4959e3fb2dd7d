// Guided paths against plain ones, quadrature and a furnace; the columns they use against those that are integrated.
#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <numbers>

#include "reference/atmosphere_paths.hpp"

namespace lumo::reference {
namespace {

using scene::earth;

constexpr double pi = std::numbers::pi;

Atmosphere haze() {
    Atmosphere a = earth();
    for (double& s : a.mie->scattering_per_km) s *= 20;
    for (double& s : a.mie->extinction_per_km) s *= 20;
    a.ground_albedo = {0, 0.5, 1};
    return a;
}

TEST(AtmosphereColumnTable, IsTheIntegral) {
    const AtmosphereOptics optics(earth());
    const ColumnTable table(optics);
    double sum = 0;
    int count = 0;
    for (double h = 0; h < 60; h = 1.07 * h + 0.003) {
        for (double above = 0; above < 1; above = 1.09 * above + 0.0007) {
            const double mu = optics.horizon_mu(h) + above;
            const Densities exact = optics.sun_column(h, mu);
            const Densities found = table.to_sun(h, mu, optics.densities(h));
            for (size_t i = 0; i < 3; ++i) {
                const double off = std::abs(optics.extinction(found, i) - optics.extinction(exact, i));
                EXPECT_LT(off, 7e-4) << h << ' ' << mu;
                sum += off;
                ++count;
            }
        }
    }
    EXPECT_LT(sum / count, 3e-5);
}

/// One comb at many places is the integral: of order 1, in thin air and thick, up, down, level, short, and from space.
TEST(AtmosphereComb, HasNoBias) {
    for (const Atmosphere& a : {earth(), haze()}) {
        const AtmosphereOptics optics(a);
        const GuidedPaths paths(optics);
        for (const SkyView& view : {SkyView{0, 30, 50, 40}, SkyView{0, 89, 85, 0}, SkyView{8, 95, 60, 170},
                                    SkyView{400, 109.5, 80, 0}, SkyView{0, 90, 70, 0, 15},
                                    SkyView{25, 94, 94, 20}, SkyView{3, 150, 20, 0, 2}}) {
            const Spectrum exact = radiance_order1(optics, view);
            const Estimate found = paths.radiance(view, {.first_order = 1, .last_order = 1, .samples = 4096});
            for (size_t i = 0; i < 3; ++i) {
                EXPECT_NEAR(found.mean[i], exact[i], 4 * found.error[i] + 3e-4 * exact[i])
                    << view.altitude_km << ' ' << view.view_zenith_deg;
                EXPECT_LT(found.error[i], 2e-3 * exact[i]) << view.altitude_km << ' ' << view.view_zenith_deg;
            }
        }
    }
}

/// Values that are off by so many standard errors of both, squared.
class Deviation {
  public:
    void add(const Estimate& a, const Estimate& b) {
        for (size_t i = 0; i < a.mean.size(); ++i) {
            const double variance = a.error[i] * a.error[i] + b.error[i] * b.error[i];
            if (variance == 0) continue;
            const double off = (a.mean[i] - b.mean[i]) / std::sqrt(variance);
            EXPECT_LT(std::abs(off), 4.5) << a.mean[i] << ' ' << b.mean[i];
            squares_ += off * off;
            ++count_;
        }
    }
    double mean_square() const { return squares_ / count_; }

  private:
    double squares_ = 0;
    int count_ = 0;
};

TEST(AtmospherePaths, GuidedPathsFindWhatPlainOnesFind) {
    Deviation all;
    for (const Atmosphere& a : {earth(), haze()}) {
        const AtmosphereOptics optics(a);
        const GuidedPaths guided(optics);
        for (const SkyView& view : {SkyView{0, 30, 50, 40}, SkyView{0, 89, 88, 5}, SkyView{1, 91.5, 94, 30},
                                    SkyView{400, 109, 60, 170}, SkyView{10, 100, 20, 90, 20}}) {
            for (const auto& [first, last] :
                 {std::pair{2u, 2u}, std::pair{3u, 3u}, std::pair{2u, all_orders}}) {
                const PathSettings few{.first_order = first, .last_order = last, .samples = 2048};
                PathSettings many = few;
                many.samples = 4000;
                all.add(guided.radiance(view, few), radiance(optics, view, many));
            }
            const PathSettings four{.first_order = 1, .last_order = 4, .samples = 2048};
            PathSettings many = four;
            many.samples = 4000;
            all.add(guided.sky_irradiance(view, four), sky_irradiance(optics, view, many));
        }
    }
    EXPECT_LT(all.mean_square(), 1.5);
}

TEST(AtmospherePaths, TwilightIsQuiet) {
    const AtmosphereOptics optics(earth());
    const GuidedPaths guided(optics);
    const PathSettings settings{.first_order = 2, .last_order = 4, .samples = 16'384};
    for (const SkyView& view :
         {SkyView{0, 60, 95, 120}, SkyView{10, 120, 94, 60}, SkyView{25, 100, 92.5, 0}}) {
        const Estimate found = guided.radiance(view, settings), plain = radiance(optics, view, settings);
        for (size_t i = 0; i < 3; ++i) {
            EXPECT_LT(found.error[i], 0.01 * found.mean[i]) << view.altitude_km;
            EXPECT_LT(found.error[i], 0.4 * plain.error[i]) << view.altitude_km;
        }
    }
}

/// Under uniform light of radiance 1 a conservative atmosphere over white ground looks the same in every direction:
/// what a ray collects from suns all over the sky is 1 less what it lets through.
TEST(AtmospherePaths, NothingIsCreatedInAFurnace) {
    const AtmosphereOptics optics(
        {.wavelengths_nm = {440},
         .sun_irradiance = {1},
         .rayleigh = scene::RayleighSpecies{.scattering_per_km = {0.04}},
         .mie = scene::MieSpecies{.scattering_per_km = {0.05}, .extinction_per_km = {0.05}},
         .ground_albedo = {1}});
    const GuidedPaths paths(optics);
    for (const double zenith : {20.0, 85.0}) {
        double sum = 0;
        constexpr uint32_t suns = 2048;
        for (uint32_t k = 0; k < suns; ++k) {
            const double sun_zenith = std::acos(1 - 2 * (k + 0.5) / suns) * 180 / pi;
            const double azimuth = 180 * std::fmod(k * 0.6180339887498949, 1.0);
            sum += 4 * pi / suns *
                   paths
                       .radiance({0, zenith, sun_zenith, azimuth},
                                 {.first_order = 1, .last_order = all_orders, .samples = 16, .seed = k})
                       .mean[0];
        }
        EXPECT_NEAR(sum + optics.transmittance_to_space({.h = 0, .mu = cos_degrees(zenith)})[0], 1, 0.03)
            << zenith;
    }
}

TEST(AtmospherePaths, SameSeedSameLight) {
    const AtmosphereOptics optics(earth());
    const GuidedPaths paths(optics);
    const SkyView view{0, 40, 60, 0};
    const Estimate a = paths.radiance(view, {.samples = 64, .seed = 7});
    EXPECT_EQ(a.mean, paths.radiance(view, {.samples = 64, .seed = 7}).mean);
    EXPECT_NE(a.mean, paths.radiance(view, {.samples = 64, .seed = 8}).mean);
}

TEST(AtmospherePaths, ExtremesAreFiniteAndNotNegative) {
    Atmosphere planetoid = earth(), stiff = earth(), dust = earth();
    planetoid.radius_ground_km = 60;
    planetoid.radius_top_km = 120;
    for (double& s : stiff.rayleigh->scattering_per_km) s *= 50;
    stiff.mie->scale_height_km = 0.1;
    dust.rayleigh.reset();
    dust.ozone.reset();
    for (const Atmosphere& a : {planetoid, stiff, dust}) {
        const AtmosphereOptics optics(a);
        const GuidedPaths paths(optics);
        for (const double h : {0.0, 1e-6, 1.0, a.height_km(), 1e4}) {
            const double horizon = std::acos(optics.horizon_mu(h)) * 180 / pi;
            for (const double zenith : {0.0, 90.0, horizon, 180.0}) {
                for (const double sun : {0.0, 90.0, 108.0, 180.0}) {
                    const SkyView view{h, zenith, sun, 0};
                    Spectrum light = paths.radiance(view, {.last_order = all_orders, .samples = 32}).mean;
                    const Spectrum level = paths.sky_irradiance(view, {.samples = 32}).mean;
                    light.insert(light.end(), level.begin(), level.end());
                    for (const double value : light)
                        EXPECT_TRUE(std::isfinite(value) && value >= 0) << h << ' ' << zenith << ' ' << sun;
                }
            }
        }
    }
}

}  // namespace
}  // namespace lumo::reference
