#include "reference/atmosphere_paths.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>

#include "reference/atmosphere_phase.hpp"
#include "reference/sampler.hpp"

namespace lumo::reference {
namespace {

constexpr double pi = std::numbers::pi;

/// The numbers of one sample, in order.
class Numbers {
  public:
    Numbers(uint32_t stream, uint32_t index) : sampler_(stream, index) {}

    glm::dvec2 pair() { return sampler_.pair(dimension_++); }

  private:
    Sampler sampler_;
    uint32_t dimension_ = 0;
};

/// A point that light leaves: its vertical, and the light's direction.
struct Vertex {
    glm::dvec3 up{0, 0, 1};
    double h = 0;
    bool ground = false;
    Densities density = {};
};

class Walk {
  public:
    Walk(const AtmosphereOptics& optics, const ColumnTable& columns, const LightGuide& guide,
         glm::dvec3 to_sun, const PathSettings& settings)
        : optics_(optics),
          a_(optics.atmosphere()),
          guide_(guide),
          to_sun_(to_sun),
          settings_(settings),
          comb_(optics, columns) {}

    /// Adds factor · the radiance that one path finds.
    void trace(Vertex at, glm::dvec3 along, double longest_km, double factor, Numbers& numbers,
               Spectrum& sum) {
        throughput_.assign(optics_.wavelengths(), factor);
        for (uint32_t order = 1; order <= settings_.last_order; ++order) {
            const double nu = glm::dot(along, to_sun_);
            const glm::dvec2 u = numbers.pair();
            if (!comb_.march({.start = {at.h, std::clamp(glm::dot(at.up, along), -1.0, 1.0)},
                              .mu_sun = glm::dot(at.up, to_sun_),
                              .nu = nu,
                              .longest_km = longest_km,
                              .from_ground = at.ground},
                             u.x))
                return;
            longest_km = std::numeric_limits<double>::infinity();
            const bool ground = comb_.reaches_ground() && order > 1;
            if (order >= settings_.first_order) add_sunlight(nu, ground, sum);
            if (order == settings_.last_order || !move(at, along, ground, u.y)) return;
            const glm::dvec2 choice = numbers.pair();  // of a technique; by roulette
            if (!survives(order, choice.y)) return;
            along = at.ground ? reflect(at, choice.x, numbers) : scatter(at, along, choice.x, numbers);
        }
    }

  private:
    static constexpr uint32_t certain_orders = 6;  ///< before roulette begins

    void add_sunlight(double nu, bool ground, Spectrum& sum) const {
        for (size_t i = 0; i < sum.size(); ++i) {
            double light = 0;
            for (size_t k = 0; k < Comb::teeth; ++k) {
                if (comb_.sun(k, i) <= 0) continue;
                const Comb::Tooth& tooth = comb_.tooth(k);
                light += tooth.width * comb_.transmittance(k, i) * comb_.sun(k, i) *
                         phase_times_scattering(optics_, tooth.density, nu, i);
            }
            if (ground)
                light += comb_.transmittance(Comb::teeth, i) * comb_.sun(Comb::teeth, i) *
                         a_.ground_albedo[i] / pi;
            sum[i] += throughput_[i] * light;
        }
    }

    /// To a tooth, or the ground; false if there is nothing that scatters. Chances are means over the wavelengths of
    /// such that each sum to 1. A part of the choices asks for the light that would be sent on under an even sky.
    bool move(Vertex& at, glm::dvec3 along, bool ground, double u) {
        constexpr double even = 0.15;
        const size_t ends = Comb::teeth + (ground ? 1 : 0);
        std::array<double, Comb::teeth + 1> chances{}, any{}, lit{};
        std::array<LightGuide::Arriving, Comb::teeth + 1> arriving;
        for (size_t k = 0; k < ends; ++k)
            arriving[k] = guide_.arriving(comb_.tooth(k).h, comb_.tooth(k).mu_sun);
        double all_chances = 0;
        for (size_t i = 0; i < throughput_.size(); ++i) {
            double all_any = 0, all_lit = 0;
            for (size_t k = 0; k < ends; ++k) {
                const Comb::Tooth& tooth = comb_.tooth(k);
                any[k] = comb_.transmittance(k, i) * (k < Comb::teeth
                                                          ? tooth.width * optics_.scattering(tooth.density, i)
                                                          : a_.ground_albedo[i]);
                lit[k] = any[k] * arriving[k](i);
                all_any += any[k];
                all_lit += lit[k];
            }
            for (size_t k = 0; k < ends; ++k) {
                const double part = (all_any > 0 ? even * any[k] / all_any : 0) +
                                    (all_lit > 0 ? (1 - even) * lit[k] / all_lit : 0);
                chances[k] += part;
                all_chances += part;
            }
        }
        if (all_chances <= 0) return false;
        double chance = 0;
        size_t chosen = 0;
        for (size_t k = 0; k < ends; ++k) {
            const double part = chances[k] / all_chances;
            if (part <= 0) continue;
            chosen = k;
            chance = part;
            if (u < part) break;
            u -= part;
        }
        const Comb::Tooth& tooth = comb_.tooth(chosen);
        const bool air = chosen < Comb::teeth;
        for (size_t i = 0; i < throughput_.size(); ++i)
            throughput_[i] *= comb_.transmittance(chosen, i) * (air ? tooth.width : 1) / chance;
        at = {.up = glm::normalize(at.up * optics_.radius(at.h) + along * tooth.distance),
              .h = tooth.h,
              .ground = !air,
              .density = tooth.density};
        return true;
    }

    /// Columns: two level directions, the first toward the sun, and the vertical.
    glm::dmat3 frame_at(const Vertex& at) const {
        const glm::dvec3 level = to_sun_ - at.up * glm::dot(at.up, to_sun_);
        const double length = glm::length(level);
        if (length < 1e-9) return frame_about(at.up);
        return {level / length, glm::cross(at.up, level / length), at.up};
    }

    glm::dvec3 reflect(const Vertex& at, double technique, Numbers& numbers) {
        const LightGuide::Lobe lobe = guide_.lobe(at.h, glm::dot(at.up, to_sun_));
        const glm::dvec2 u = numbers.pair();
        const glm::dvec3 local = technique < 0.5 ? lobe.sample(u) : cosine_direction(u);
        const double cosine = std::max(local.z, 0.0);
        const double density = 0.5 * lobe.density(local) + 0.5 * cosine / pi;
        for (size_t i = 0; i < throughput_.size(); ++i)
            throughput_[i] *= a_.ground_albedo[i] / pi * cosine / density;
        return glm::normalize(frame_at(at) * local);
    }

    glm::dvec3 scatter(const Vertex& at, glm::dvec3 along, double technique, Numbers& numbers) {
        const glm::dmat3 frame = frame_at(at);
        double by_mie = 0;
        for (size_t i = 0; i < throughput_.size(); ++i)
            by_mie += optics_.scattering({.mie = at.density.mie}, i) / optics_.scattering(at.density, i) /
                      double(throughput_.size());
        const double g = a_.mie ? a_.mie->g : 0;
        const LightGuide::Lobe lobe =
            guide_.lobe(at.h, glm::dot(at.up, to_sun_), glm::transpose(frame) * along, by_mie);
        constexpr double guided = 0.7;
        const glm::dvec2 u = numbers.pair();
        glm::dvec3 next;
        if (technique < guided)
            next = glm::normalize(frame * lobe.sample(u));
        else if (technique - guided < (1 - guided) * by_mie)
            next = turned(along, sample_henyey_greenstein(g, 1 - u.x), u.y);
        else
            next = turned(along, sample_rayleigh(u.x), u.y);
        const double nu = glm::dot(along, next);
        const double density =
            guided * lobe.density(glm::transpose(frame) * next) +
            (1 - guided) * (by_mie * henyey_greenstein(nu, g) + (1 - by_mie) * rayleigh_phase(nu));
        for (size_t i = 0; i < throughput_.size(); ++i)
            throughput_[i] *= phase_times_scattering(optics_, at.density, nu, i) / density;
        return next;
    }

    /// Russian roulette with one chance for all paths: what they carry is bounded, and little is left of it.
    bool survives(uint32_t order, double u) {
        if (order < certain_orders) return true;
        constexpr double chance = 0.85;
        if (u >= chance) return false;
        for (double& part : throughput_) part /= chance;
        return true;
    }

    const AtmosphereOptics& optics_;
    const Atmosphere& a_;
    const LightGuide& guide_;
    glm::dvec3 to_sun_;
    PathSettings settings_;
    Comb comb_;
    Spectrum throughput_ = {};
};

/// The mean of what `sample` adds, over the streams.
template <class F>
Estimate mean_of(size_t wavelengths, const PathSettings& settings, const F& sample) {
    constexpr uint32_t streams = 16;
    const uint32_t count = std::bit_floor(std::max(settings.samples / streams, 1u));
    const auto seed = hash(uint32_t(settings.seed), uint32_t(settings.seed >> 32));
    Estimate sums{.mean = Spectrum(wavelengths, 0), .error = Spectrum(wavelengths, 0)};
    Spectrum one(wavelengths);
    for (uint32_t stream = 0; stream < streams; ++stream) {
        std::ranges::fill(one, 0);
        for (uint32_t s = 0; s < count; ++s) {
            Numbers numbers(hash(seed, stream), s);
            sample(numbers, one);
        }
        for (size_t i = 0; i < wavelengths; ++i) {
            sums.mean[i] += one[i] / count;
            sums.error[i] += one[i] / count * (one[i] / count);
        }
    }
    for (size_t i = 0; i < wavelengths; ++i) {
        sums.mean[i] /= streams;
        const double variance = std::max(sums.error[i] / streams - sums.mean[i] * sums.mean[i], 0.0);
        sums.error[i] = std::sqrt(variance / (streams - 1));
    }
    return sums;
}

}  // namespace

GuidedPaths::GuidedPaths(const AtmosphereOptics& optics)
    : optics_(optics), columns_(optics), guide_(optics, columns_) {}

Estimate GuidedPaths::radiance(const SkyView& view, const PathSettings& settings) const {
    Walk walk(optics_, columns_, guide_, sky_direction(view.sun_zenith_deg, 0), settings);
    const glm::dvec3 along = sky_direction(view.view_zenith_deg, view.azimuth_deg);
    return mean_of(optics_.wavelengths(), settings, [&](Numbers& numbers, Spectrum& sum) {
        walk.trace({.h = view.altitude_km}, along, view.distance_km, 1, numbers, sum);
    });
}

/// Directions in part by the cosine, in part by the guide, weighted by the balance of both (Veach 1997, section 9.2.2).
Estimate GuidedPaths::sky_irradiance(const SkyView& view, const PathSettings& settings) const {
    const glm::dvec3 to_sun = sky_direction(view.sun_zenith_deg, 0);
    Walk walk(optics_, columns_, guide_, to_sun, settings);
    const LightGuide::Lobe lobe = guide_.lobe(view.altitude_km, to_sun.z);
    return mean_of(optics_.wavelengths(), settings, [&](Numbers& numbers, Spectrum& sum) {
        const bool guided = numbers.pair().x < 0.5;
        const glm::dvec2 u = numbers.pair();
        const glm::dvec3 along = guided ? lobe.sample(u) : cosine_direction(u);
        if (along.z <= 0) return;
        const double density = 0.5 * lobe.density(along) + 0.5 * along.z / pi;
        walk.trace({.h = view.altitude_km}, along, std::numeric_limits<double>::infinity(), along.z / density,
                   numbers, sum);
    });
}

}  // namespace lumo::reference
