#include "techniques/cones/distribution.hpp"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <optional>

namespace lumo::cones {
namespace {

struct Ring {
    double polar = 0;  ///< radians, of its circles' centres
    int cones = 0;
};

/// Circles of this half-angle that fit side by side on a ring: neighbours' centres are 2 half_angle apart,
/// which is sin(half_angle) = sin(polar) sin(pi / n).
int ring_capacity(double polar, double half_angle) {
    const double ratio = std::sin(half_angle) / std::sin(polar);
    if (ratio >= 1) return polar > half_angle ? 2 : 1;
    return int(std::floor(glm::pi<double>() / std::asin(ratio) + 1e-9));
}

/// Rings that hold `count` circles of this half-angle from the pole down, the innermost at `first_polar`;
/// nothing when they do not fit above the horizon.
std::optional<std::vector<Ring>> pack(int count, double half_angle, double first_polar) {
    std::vector<Ring> rings;
    for (double polar = first_polar; count > 0; polar += 2 * half_angle) {
        if (polar + half_angle > glm::half_pi<double>() + 1e-9) return std::nullopt;
        const int capacity = polar < 1e-9 ? 1 : ring_capacity(polar, half_angle);
        rings.push_back({polar, std::min(count, capacity)});
        count -= rings.back().cones;
    }
    return rings;
}

/// The widest circles that fit, with one circle at the pole or a first ring around it.
struct Packing {
    double half_angle = 0;
    std::vector<Ring> rings;
};
Packing widest(int count, bool circle_at_pole) {
    Packing best;
    double low = 0, high = glm::half_pi<double>();
    for (int i = 0; i < 60; ++i) {
        const double middle = (low + high) / 2;
        if (auto rings = pack(count, middle, circle_at_pole ? 0 : middle)) {
            best = {middle, std::move(*rings)};
            low = middle;
        } else {
            high = middle;
        }
    }
    return best;
}

}  // namespace

Distribution distribute(int count) {
    count = std::clamp(count, 1, max_cones);
    Packing centred = widest(count, true);
    Packing open = widest(count, false);
    const Packing& packing = count > 1 && open.half_angle > centred.half_angle ? open : centred;

    Distribution result;
    result.half_angle = float(std::min(packing.half_angle, glm::radians(75.0)));
    double sin2_above = 0;
    for (size_t r = 0; r < packing.rings.size(); ++r) {
        const Ring& ring = packing.rings[r];
        const bool last = r + 1 == packing.rings.size();
        const double boundary = last ? glm::half_pi<double>() : (ring.polar + packing.rings[r + 1].polar) / 2;
        const double sin2 = std::sin(boundary) * std::sin(boundary);
        for (int i = 0; i < ring.cones; ++i) {
            // Half a step from ring to ring keeps cones from lining up.
            const double azimuth = glm::two_pi<double>() * (i + 0.5 * (r % 2)) / ring.cones;
            result.cones.push_back({glm::vec3(std::sin(ring.polar) * std::cos(azimuth),
                                              std::sin(ring.polar) * std::sin(azimuth), std::cos(ring.polar)),
                                    float((sin2 - sin2_above) / ring.cones)});
        }
        sin2_above = sin2;
    }
    return result;
}

}  // namespace lumo::cones
