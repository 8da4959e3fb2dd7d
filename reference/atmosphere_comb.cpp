#include "reference/atmosphere_comb.hpp"

#include <algorithm>
#include <cmath>

namespace lumo::reference {

Comb::Comb(const AtmosphereOptics& optics, const ColumnTable& columns)
    : optics_(optics),
      columns_(columns),
      size_(optics.wavelengths()),
      tooth_(teeth + 1),
      transmittance_((teeth + 1) * size_),
      sun_((teeth + 1) * size_) {}

bool Comb::march(const SunnyRay& ray, double place) {
    const RayPoint start =
        ray.from_ground ? RayPoint{.h = 0, .mu = std::max(ray.start.mu, 1e-12)} : ray.start;
    const auto path = optics_.air_path(start);
    if (!path) return false;
    const double length = std::min(path->length, ray.longest_km - path->entry);
    if (!(length > 0)) return false;
    ground_ = path->ground && length == path->length;

    // Columns are differences of those of lines to space; a line that falls is taken backwards, up to its lowest point.
    const double lowest = -optics_.radius(path->at.h) * path->at.mu;
    const Densities at_entry = optics_.densities(path->at.h);
    const bool falls = path->at.mu < 0;
    const Densities behind = columns_.rising({path->at.h, std::abs(path->at.mu)}, at_entry);
    Densities twice_lowest;
    if (falls && length > lowest) {
        twice_lowest = columns_.level(optics_.along(path->at, lowest).h);
        twice_lowest += twice_lowest;
    }
    const auto column = [&](double distance, const RayPoint& at, const Densities& density) {
        const Densities ahead = columns_.rising({at.h, std::abs(at.mu)}, density);
        const auto between = [&](double Densities::*part) {
            const double sum = distance <= lowest ? ahead.*part - behind.*part
                               : falls            ? twice_lowest.*part - behind.*part - ahead.*part
                                                  : behind.*part - ahead.*part;
            return std::max(sum, 0.0);
        };
        return Densities{between(&Densities::rayleigh), between(&Densities::mie), between(&Densities::ozone)};
    };

    const double r_sun = optics_.radius(ray.start.h) * ray.mu_sun + ray.nu * path->entry;
    const auto put = [&](size_t k, double distance, double width) {
        const RayPoint at = optics_.along(path->at, distance);
        Tooth& tooth = tooth_[k];
        tooth = {.width = width,
                 .distance = path->entry + distance,
                 .h = at.h,
                 .mu_sun = std::clamp((r_sun + ray.nu * distance) / optics_.radius(at.h), -1.0, 1.0),
                 .density = optics_.densities(at.h)};
        see(k, column(distance, at, tooth.density), k == teeth ? std::max(tooth.mu_sun, 0.0) : 1);
    };
    const double middle = std::clamp(lowest, 0.0, length);
    const size_t falling = middle <= 0 ? 0 : middle >= length ? teeth : teeth / 2;
    const size_t rising = teeth - falling;
    for (size_t k = 0; k < falling; ++k) {
        const double u = 1 - (double(k) + place) / double(falling);
        put(k, middle * (1 - u * u), middle * 2 * u / double(falling));
    }
    for (size_t k = 0; k < rising; ++k) {
        const double u = (double(k) + place) / double(rising);
        put(falling + k, middle + (length - middle) * u * u, (length - middle) * 2 * u / double(rising));
    }
    if (ground_) put(teeth, length, 0);
    return true;
}

void Comb::see(size_t k, const Densities& column, double factor) {
    const Tooth& tooth = tooth_[k];
    const double visible = factor * optics_.sun_visibility(tooth.h, tooth.mu_sun);
    const Densities beyond =
        visible > 0 ? columns_.to_sun(tooth.h, tooth.mu_sun, tooth.density) : Densities{};
    for (size_t i = 0; i < size_; ++i) {
        transmittance_[k * size_ + i] = std::exp(-optics_.extinction(column, i));
        sun_[k * size_ + i] = visible > 0 ? visible * optics_.atmosphere().sun_irradiance[i] *
                                                std::exp(-optics_.extinction(beyond, i))
                                          : 0;
    }
}

}  // namespace lumo::reference
