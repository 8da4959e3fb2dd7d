#include "reference/atmosphere_light.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/glm.hpp>
#include <numbers>

#include "reference/atmosphere_phase.hpp"
#include "reference/sampler.hpp"

namespace lumo::reference {
namespace {

constexpr double pi = std::numbers::pi;

/// Adds the real roots of a x² + 2 b x + c = 0 that lie within (0, length).
void add_roots(double a, double b, double c, double length, std::vector<double>& roots) {
    const double discriminant = b * b - a * c;
    if (discriminant < 0) return;
    const double q = -(b + std::copysign(std::sqrt(discriminant), b));
    if (q == 0) return;
    for (const double x : {c / q, a != 0 ? q / a : -1.0})
        if (x > 0 && x < length) roots.push_back(x);
}

/// Distances at which the integrand of order 1 along a path bends: the perigee, the borders of layers, and where the
/// sun's disc touches the horizon from below, is halved by it, and touches it from above.
///
/// With w the cosine between ray and sun, r mu_sun is A + w d on the ray, and the disc's place relative to the horizon
/// is A + w d + sqrt(r² - R²) = c for c = -alpha R, 0, alpha R: each a quadratic in d.
std::vector<double> bends(const AtmosphereOptics& optics, RayPoint from, double length, double mu_sun,
                          double nu) {
    const Atmosphere& a = optics.atmosphere();
    const double ground = a.radius_ground_km, r = optics.radius(from.h), b = r * from.mu;
    std::vector<double> at{0, length};
    if (-b > 0 && -b < length) at.push_back(-b);
    for (const double h : optics.borders()) add_roots(1, b, (from.h - h) * (r + ground + h), length, at);
    const double alpha = a.sun_angular_radius_deg * (pi / 180);
    for (const double c : {-alpha * ground, 0.0, alpha * ground}) {
        const double rest = c - r * mu_sun;
        add_roots(1 - nu * nu, b + nu * rest, from.h * (r + ground) - rest * rest, length, at);
    }
    std::ranges::sort(at);
    return at;
}

/// Halves an interval until two halves agree with the whole to `tolerance` of the greatest sum met so far.
template <class F>
void integrate_adaptively(double from, double to, const Spectrum& whole, int depth, double tolerance,
                          const F& rule, Spectrum& sum) {
    const double middle = 0.5 * (from + to);
    const Spectrum left = rule(from, middle), right = rule(middle, to);
    bool converged = depth <= 0;
    if (!converged) {
        converged = true;
        for (size_t i = 0; i < sum.size(); ++i)
            converged &= std::abs(left[i] + right[i] - whole[i]) <= tolerance * (sum[i] + left[i] + right[i]);
    }
    if (converged) {
        for (size_t i = 0; i < sum.size(); ++i) sum[i] += left[i] + right[i];
        return;
    }
    integrate_adaptively(from, middle, left, depth - 1, tolerance, rule, sum);
    integrate_adaptively(middle, to, right, depth - 1, tolerance, rule, sum);
}

/// SplitMix64 (Steele, Lea, Flood 2014): a stream for each pair of seed and index.
class Random {
  public:
    Random(uint64_t seed, uint64_t index) : state_(mix(mix(seed) + index)) {}

    double number() {  // in (0, 1)
        state_ += 0x9e3779b97f4a7c15u;
        return (double(mix(state_) >> 11) + 0.5) * 0x1p-53;
    }
    glm::dvec2 pair() {
        const double x = number();
        return {x, number()};
    }

  private:
    static uint64_t mix(uint64_t x) {
        x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9u;
        x = (x ^ x >> 27) * 0x94d049bb133111ebu;
        return x ^ x >> 31;
    }
    uint64_t state_;
};

/// About how much of the sun reaches a point of the air, 0 to 1: a coarse table of its mean over the wavelengths.
class SunTable {
  public:
    explicit SunTable(const AtmosphereOptics& optics) : optics_(optics) {
        lowest_ = -1.1 * (optics.atmosphere().sun_angular_radius_deg * (pi / 180));
        for (size_t i = 0; i < altitudes; ++i) {
            const double part = double(i) / (altitudes - 1);
            const double h = optics.atmosphere().height_km() * part * part;
            for (size_t k = 0; k < places; ++k) {
                const double place = double(k) / (places - 1);
                const double mu = std::min(optics.horizon_mu(h) + lowest_ + place * place * width, 1.0);
                const double visible = optics.sun_visibility(h, mu);
                if (visible <= 0) continue;
                for (const double t : optics.transmittance(optics.sun_column(h, mu)))
                    values_[i * places + k] += visible * t / double(optics.wavelengths());
            }
        }
    }

    double at(double h, double mu_sun) const {
        const double above = mu_sun - optics_.horizon_mu(h) - lowest_;
        if (above <= 0) return 0;
        const double x = std::sqrt(std::min(above / width, 1.0)) * (places - 1);
        const double y = std::sqrt(std::min(h / optics_.atmosphere().height_km(), 1.0)) * (altitudes - 1);
        const size_t k = std::min(size_t(x), places - 2), i = std::min(size_t(y), altitudes - 2);
        const double* low = &values_[i * places + k];
        const double* high = low + places;
        return std::lerp(std::lerp(low[0], low[1], x - double(k)), std::lerp(high[0], high[1], x - double(k)),
                         y - double(i));
    }

  private:
    static constexpr size_t altitudes = 12, places = 16;
    static constexpr double width = 0.4;  ///< in the cosine, above the horizon: what is higher is alike

    const AtmosphereOptics& optics_;
    double lowest_ = 0;
    std::array<double, altitudes * places> values_{};
};

/// Paths from the eye, with the sun asked for at each event (next-event estimation). Distances and directions are drawn
/// for the mean over the wavelengths, distances in part for what scatters and in part for what scatters sunlight, by
/// densities that are known exactly; what they are weighted with is exact for each wavelength, so that the estimate is
/// unbiased however coarse the density is.
class PathIntegrator {
  public:
    PathIntegrator(const AtmosphereOptics& optics, glm::dvec3 to_sun, const PathSettings& settings)
        : optics_(optics), a_(optics.atmosphere()), sun_(optics), to_sun_(to_sun), settings_(settings) {}

    /// Adds factor · the radiance that one path finds.
    void trace(double h, glm::dvec3 along, double max_distance, double factor, Random& random,
               Spectrum& sum) {
        Vertex at{.up = {0, 0, 1}, .h = h};
        throughput_.assign(optics_.wavelengths(), factor);
        for (uint32_t order = 1; order <= settings_.last_order; ++order) {
            const bool first = order == 1;
            if (!move(at, along, first ? max_distance : infinite, order, random)) return;
            if (order >= settings_.first_order) add_sun(at, along, sum);
            if (order == settings_.last_order || !survives(order, random)) return;
            along = at.ground ? reflect(at, random) : scatter(at, along, random);
        }
    }

  private:
    static constexpr double infinite = std::numeric_limits<double>::infinity();
    static constexpr size_t bins = 24;
    static constexpr uint32_t certain_orders = 6;  ///< before roulette begins

    struct Vertex {
        glm::dvec3 up{0, 0, 1};
        double h = 0;
        bool ground = false;
        Densities density = {};
    };

    double mean_extinction(const Densities& d) const {
        double sum = 0;
        for (size_t i = 0; i < throughput_.size(); ++i) sum += optics_.extinction(d, i);
        return sum / double(throughput_.size());
    }
    double mean_scattering(const Densities& d) const {
        double sum = 0;
        for (size_t i = 0; i < throughput_.size(); ++i) sum += optics_.scattering(d, i);
        return sum / double(throughput_.size());
    }

    /// To the next event; false if there is none. Distances have a density that is constant in each of some bins, which
    /// are finer toward the ground, where the air is; a hundredth of it is uniform over the distance.
    bool move(Vertex& at, glm::dvec3 along, double max_distance, uint32_t order, Random& random) {
        const RayPoint start{.h = at.h, .mu = std::clamp(glm::dot(at.up, along), -1.0, 1.0)};
        // Rounding must not send light from the ground into it.
        const auto path =
            optics_.air_path(at.ground ? RayPoint{.h = 0, .mu = std::max(start.mu, 1e-12)} : start);
        if (!path) return false;
        const bool reaches_ground = path->ground && path->entry + path->length <= max_distance;
        const double length = std::min(path->length, max_distance - path->entry);
        if (!(length > 0)) return false;

        // Each side of the lowest point has edges that are the squares of even steps from it.
        std::array<double, bins + 1> edge;
        const double lowest = std::clamp(-optics_.radius(path->at.h) * path->at.mu, 0.0, length);
        const size_t falling = lowest <= 0 ? 0 : lowest >= length ? bins : bins / 2;
        for (size_t i = 0; i < falling; ++i) {
            const double u = 1 - double(i) / double(falling);
            edge[i] = lowest * (1 - u * u);
        }
        edge[falling] = lowest;
        for (size_t i = falling + 1; i <= bins; ++i) {
            const double u = double(i - falling) / double(bins - falling);
            edge[i] = lowest + (length - lowest) * u * u;
        }
        const double nu = glm::dot(along, to_sun_);
        const double r_sun = optics_.radius(at.h) * glm::dot(at.up, to_sun_) + nu * path->entry;
        std::array<double, bins> weight, sunlit;
        double depth = 0, all_weight = 0, all_sunlit = 0;
        for (size_t i = 0; i < bins; ++i) {
            const double width = edge[i + 1] - edge[i], middle = 0.5 * (edge[i] + edge[i + 1]);
            const double h = optics_.along(path->at, middle).h;
            const Densities d = optics_.densities(h);
            const double bin_depth = mean_extinction(d) * width;
            weight[i] = mean_scattering(d) * width * std::exp(-depth - 0.5 * std::min(bin_depth, 2.0));
            sunlit[i] = weight[i] * sun_.at(h, (r_sun + nu * middle) / optics_.radius(h));
            depth += bin_depth;
            all_weight += weight[i];
            all_sunlit += sunlit[i];
        }
        // Toward the sun the ground is four times as bright as air that scatters as much in all directions.
        const double mu_sun = (r_sun + nu * length) / a_.radius_ground_km;
        const double reflected = reaches_ground && order > 1 ? std::exp(-depth) * mean_albedo() : 0;
        const double reflected_sun =
            reflected > 0 ? 4 * reflected * std::max(mu_sun, 0.0) * sun_.at(0, mu_sun) : 0;
        all_weight += reflected;
        all_sunlit += reflected_sun;
        if (all_weight <= 0) return false;
        const double part = sunlit_part(order, all_sunlit);
        const auto mixed = [&](double any, double lit) {
            return (1 - part) * any / all_weight + (part > 0 ? part * lit / all_sunlit : 0);
        };
        double total = 0;
        for (size_t i = 0; i < bins; ++i) {
            weight[i] = mixed(weight[i], sunlit[i]);
            total += weight[i];
        }

        const double reflection = mixed(reflected, reflected_sun);
        double chance_of_air = total / (total + reflection);
        if (reflection > 0 && total > 0) chance_of_air = std::clamp(chance_of_air, 0.05, 0.95);
        double distance = length;
        if (random.number() < chance_of_air) {
            constexpr double uniform = 0.01;
            double pick = random.number();
            if (pick < uniform) {
                distance = length * pick / uniform;
            } else {
                pick = (pick - uniform) / (1 - uniform) * total;
                size_t i = 0;
                while (i + 1 < bins && pick >= weight[i]) pick -= weight[i++];
                distance = edge[i] + (edge[i + 1] - edge[i]) * std::min(pick / weight[i], 1.0);
            }
            const auto bin =
                std::min(size_t(std::ranges::upper_bound(edge, distance) - edge.begin()), bins) - 1;
            const double density =
                uniform / length + (1 - uniform) * weight[bin] / (total * (edge[bin + 1] - edge[bin]));
            const RayPoint there = optics_.along(path->at, distance);
            weigh(optics_.column(path->at, distance), 1 / (density * chance_of_air));
            at = {.up = up_after(at, along, path->entry + distance),
                  .h = there.h,
                  .density = optics_.densities(there.h)};
        } else {
            weigh(optics_.column(path->at, length), 1 / (1 - chance_of_air));
            at = {.up = up_after(at, along, path->entry + length), .h = 0, .ground = true};
        }
        return true;
    }

    /// How many distances are drawn for sunlight: none where it does not count, most where nothing else follows.
    double sunlit_part(uint32_t order, double all_sunlit) const {
        if (order < settings_.first_order || all_sunlit <= 0) return 0;
        return order == settings_.last_order ? 0.9 : 0.5;
    }
    double mean_albedo() const {
        double sum = 0;
        for (const double albedo : a_.ground_albedo) sum += albedo;
        return sum / double(a_.ground_albedo.size());
    }
    glm::dvec3 up_after(const Vertex& at, glm::dvec3 along, double distance) const {
        return glm::normalize(at.up * optics_.radius(at.h) + along * distance);
    }
    void weigh(const Densities& column, double factor) {
        for (size_t i = 0; i < throughput_.size(); ++i)
            throughput_[i] *= factor * std::exp(-optics_.extinction(column, i));
    }

    void add_sun(const Vertex& at, glm::dvec3 along, Spectrum& sum) const {
        const double mu = glm::dot(at.up, to_sun_);
        const double visible = optics_.sun_visibility(at.h, mu) * (at.ground ? std::max(mu, 0.0) : 1);
        if (visible <= 0) return;
        const Densities column = optics_.sun_column(at.h, mu);
        const double nu = glm::dot(along, to_sun_);
        for (size_t i = 0; i < sum.size(); ++i) {
            const double redirected =
                at.ground ? a_.ground_albedo[i] / pi : phase_times_scattering(optics_, at.density, nu, i);
            sum[i] += throughput_[i] * redirected * visible * a_.sun_irradiance[i] *
                      std::exp(-optics_.extinction(column, i));
        }
    }

    glm::dvec3 reflect(const Vertex& at, Random& random) {
        for (size_t i = 0; i < throughput_.size(); ++i) throughput_[i] *= a_.ground_albedo[i];
        return glm::normalize(frame_about(at.up) * cosine_direction(random.pair()));
    }

    glm::dvec3 scatter(const Vertex& at, glm::dvec3 along, Random& random) {
        const double all = mean_scattering(at.density);
        const double by_mie = a_.mie ? mean_scattering({.mie = at.density.mie}) / all : 0;
        const double g = a_.mie ? a_.mie->g : 0;
        const bool mie = random.number() < by_mie;
        const glm::dvec2 u = random.pair();
        const glm::dvec3 next =
            turned(along, mie ? sample_henyey_greenstein(g, 1 - u.x) : sample_rayleigh(u.x), u.y);
        const double nu = glm::dot(along, next);
        const double density = by_mie * henyey_greenstein(nu, g) + (1 - by_mie) * rayleigh_phase(nu);
        for (size_t i = 0; i < throughput_.size(); ++i)
            throughput_[i] *= phase_times_scattering(optics_, at.density, nu, i) / density;
        return next;
    }

    /// Russian roulette with one chance for all paths: what they carry is bounded, and little is left of it.
    bool survives(uint32_t order, Random& random) {
        if (order < certain_orders) return true;
        constexpr double chance = 0.85;
        if (random.number() >= chance) return false;
        for (double& part : throughput_) part /= chance;
        return true;
    }

    const AtmosphereOptics& optics_;
    const Atmosphere& a_;
    SunTable sun_;
    glm::dvec3 to_sun_;
    PathSettings settings_;
    Spectrum throughput_ = {};
};

/// The mean of what `sample` adds, over the samples.
template <class F>
Estimate mean_of(const AtmosphereOptics& optics, const PathSettings& settings, const F& sample) {
    Estimate sums{.mean = Spectrum(optics.wavelengths(), 0), .error = Spectrum(optics.wavelengths(), 0)};
    Spectrum one = sums.mean;
    for (uint32_t s = 0; s < settings.samples; ++s) {
        std::ranges::fill(one, 0);
        Random random(settings.seed, s);
        sample(random, one);
        for (size_t i = 0; i < one.size(); ++i) {
            sums.mean[i] += one[i];
            sums.error[i] += one[i] * one[i];
        }
    }
    const double n = std::max(double(settings.samples), 1.0);
    for (size_t i = 0; i < one.size(); ++i) {
        sums.mean[i] /= n;
        const double variance = std::max(sums.error[i] / n - sums.mean[i] * sums.mean[i], 0.0);
        sums.error[i] = std::sqrt(variance / std::max(n - 1, 1.0));
    }
    return sums;
}

}  // namespace

Spectrum radiance_order1(const AtmosphereOptics& optics, const SkyView& view, double tolerance) {
    const Atmosphere& a = optics.atmosphere();
    Spectrum sum(optics.wavelengths(), 0);
    const glm::dvec3 along = sky_direction(view.view_zenith_deg, view.azimuth_deg);
    const glm::dvec3 to_sun = sky_direction(view.sun_zenith_deg, 0);
    const auto path = optics.air_path({.h = view.altitude_km, .mu = along.z});
    if (!path) return sum;
    const double length = std::min(path->length, view.distance_km - path->entry);
    if (!(length > 0)) return sum;

    const double nu = glm::dot(along, to_sun);
    const double r_sun =
        optics.radius(view.altitude_km) * to_sun.z + nu * path->entry;  // r mu_sun at the entry
    const auto rule = [&](double from, double to) {
        Spectrum part(sum.size(), 0);
        gauss(from, to, [&](double d, double weight) {
            const RayPoint at = optics.along(path->at, d);
            const double mu_sun = (r_sun + nu * d) / optics.radius(at.h);
            const double visible = optics.sun_visibility(at.h, mu_sun);
            if (visible <= 0) return;
            const Densities local = optics.densities(at.h);
            Densities column = optics.column(path->at, d);
            column += optics.sun_column(at.h, mu_sun);
            for (size_t i = 0; i < part.size(); ++i)
                part[i] += weight * visible * a.sun_irradiance[i] *
                           phase_times_scattering(optics, local, nu, i) *
                           std::exp(-optics.extinction(column, i));
        });
        return part;
    };
    constexpr int deepest = 12;
    const std::vector<double> at = bends(optics, path->at, length, r_sun / optics.radius(path->at.h), nu);
    for (size_t i = 0; i + 1 < at.size(); ++i) {
        if (at[i + 1] > at[i])
            integrate_adaptively(at[i], at[i + 1], rule(at[i], at[i + 1]), deepest, tolerance, rule, sum);
    }
    return sum;
}

Estimate radiance(const AtmosphereOptics& optics, const SkyView& view, const PathSettings& settings) {
    PathIntegrator paths(optics, sky_direction(view.sun_zenith_deg, 0), settings);
    const glm::dvec3 along = sky_direction(view.view_zenith_deg, view.azimuth_deg);
    return mean_of(optics, settings, [&](Random& random, Spectrum& sum) {
        paths.trace(view.altitude_km, along, view.distance_km, 1, random, sum);
    });
}

/// Directions half by the cosine, half by the aerosols' lobe about the sun, weighted by the balance of both
/// (Veach 1997, section 9.2.2).
Estimate sky_irradiance(const AtmosphereOptics& optics, const SkyView& view, const PathSettings& settings) {
    const glm::dvec3 to_sun = sky_direction(view.sun_zenith_deg, 0);
    PathIntegrator paths(optics, to_sun, settings);
    const double g = optics.atmosphere().mie ? optics.atmosphere().mie->g : 0;
    return mean_of(optics, settings, [&](Random& random, Spectrum& sum) {
        const bool about_sun = random.number() < 0.5;
        const glm::dvec2 u = random.pair();
        const glm::dvec3 along =
            about_sun ? turned(to_sun, sample_henyey_greenstein(g, 1 - u.x), u.y) : cosine_direction(u);
        if (along.z <= 0) return;
        const double density = 0.5 * along.z / pi + 0.5 * henyey_greenstein(glm::dot(along, to_sun), g);
        paths.trace(view.altitude_km, along, std::numeric_limits<double>::infinity(), along.z / density,
                    random, sum);
    });
}

}  // namespace lumo::reference
