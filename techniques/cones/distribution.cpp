#include "techniques/cones/distribution.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <limits>
#include <numeric>
#include <optional>
#include <span>

namespace lumo::cones {
namespace {

struct Ring {
    double polar = 0;  ///< radians, of its circles' centres
    int cones = 0;
    double half_angle = 0;
    double weight = 0;  ///< of all its cones
};
using Rings = std::vector<Ring>;

constexpr double horizon = glm::half_pi<double>();

double lower_side(const Rings& rings) { return rings.back().polar + rings.back().half_angle; }

/// Rings of these many circles, each ring touching the one before and its circles one another, from a first one of this
/// half-angle, which is a circle at the pole where it is alone.
Rings touching(const std::vector<int>& counts, double first_half_angle) {
    Rings rings;
    double edge = 0;  // polar angle of the last ring's lower side
    for (const int count : counts) {
        const double sine = std::sin(glm::pi<double>() / count);
        Ring ring{.cones = count};
        if (!rings.empty()) {
            // sin(half_angle) = sin(edge + half_angle) sine
            ring.half_angle = std::atan2(sine * std::sin(edge), 1 - sine * std::cos(edge));
            ring.polar = edge + ring.half_angle;
        } else {
            ring.half_angle = first_half_angle;
            ring.polar = count == 1 ? 0 : std::asin(std::min(std::sin(first_half_angle) / sine, 1.0));
        }
        edge = ring.polar + ring.half_angle;
        rings.push_back(ring);
    }
    return rings;
}

/// The same, down to the horizon exactly; nothing where these counts do not get there from above.
std::optional<Rings> filling(const std::vector<int>& counts) {
    double low = 1e-3, high = glm::quarter_pi<double>() * (counts.size() == 1 ? 2 : 1.6);
    if (counts[0] > 1) high = std::min(high, glm::pi<double>() / counts[0]);
    if (lower_side(touching(counts, low)) > horizon || lower_side(touching(counts, high)) < horizon)
        return std::nullopt;
    for (int i = 0; i < 60; ++i) {
        const double middle = (low + high) / 2;
        (lower_side(touching(counts, middle)) > horizon ? high : low) = middle;
    }
    return touching(counts, low);
}

/// Solid angle, over that of the hemisphere.
double coverage(const Rings& rings) {
    double sum = 0;
    for (const Ring& ring : rings) sum += ring.cones * (1 - std::cos(ring.half_angle));
    return sum;
}

/// Every way to split `count` into rings that do not get smaller, of three circles and more behind the first.
void for_each_split(int count, std::vector<int>& counts, const auto& use) {
    if (count == 0) {
        use(counts);
        return;
    }
    const int least = counts.empty() ? 1 : std::max(counts.back(), 3);
    for (int first = least; first <= count; ++first) {
        if (first < count && count - first < std::max(first, 3)) continue;
        counts.push_back(first);
        for_each_split(count - first, counts, use);
        counts.pop_back();
    }
}

/// Rings of equal circles as wide as they fit; the first touch one another about the pole.
Rings equal(const std::vector<int>& counts) {
    Rings best;
    double low = 0, high = horizon;
    for (int i = 0; i < 50; ++i) {
        const double half_angle = (low + high) / 2;
        Rings rings;
        bool fits = true;
        for (const int count : counts) {
            const double sine = std::sin(half_angle) / std::sin(glm::pi<double>() / count);
            fits = fits && (count == 1 || sine <= 1);
            const double nearest = count == 1 ? 0 : std::asin(std::min(sine, 1.0));
            const double below = rings.empty() ? 0 : rings.back().polar + 2 * half_angle;
            rings.push_back({.polar = std::max(nearest, below), .cones = count, .half_angle = half_angle});
        }
        if (fits && lower_side(rings) <= horizon) {
            best = std::move(rings);
            low = half_angle;
        } else {
            high = half_angle;
        }
    }
    return best;
}

/// The part of a circle of latitude, `z` above the horizon, that lies within `half_angle` of a direction.
double part_within(double z, double polar, double half_angle) {
    const double across = std::sqrt(1 - z * z) * std::sin(polar);
    const double rest = std::cos(half_angle) - z * std::cos(polar);
    if (across < 1e-9) return rest <= 0 ? 1 : 0;
    return std::acos(std::clamp(rest / across, -1.0, 1.0)) / glm::pi<double>();
}

constexpr double light_half_angle = glm::pi<double>() / 6;
constexpr int latitudes = 64, lights = 16;

double latitude(int row) { return (row + 0.5) / latitudes; }
double light_polar(int light) { return std::acos((light + 0.5) / lights); }

/// Irradiance of disks of light, by light_polar, mean over azimuth; all in the same unit.
using Response = std::array<double, lights>;

/// The kernel is what light from a latitude counts.
Response response_of(const auto& kernel) {
    Response response{};
    for (int light = 0; light < lights; ++light)
        for (int row = 0; row < latitudes; ++row)
            response[size_t(light)] +=
                kernel(latitude(row)) * part_within(latitude(row), light_polar(light), light_half_angle);
    return response;
}

Response true_response() {
    return response_of([](double z) { return z; });
}

/// Of a ring that has all the weight.
Response response_of(const Ring& ring) {
    return response_of([&](double z) {
        return part_within(z, ring.polar, ring.half_angle) / (2 * (1 - std::cos(ring.half_angle)));
    });
}

/// Finds the weights of distribute(), by moving weight between pairs of rings: the error is a parabola in what is moved,
/// and convex in all, so that this ends at its least. Returns the root mean square of the error.
double fit_weights(Rings& rings) {
    static const Response truth = true_response();
    std::vector<Response> responses;
    for (Ring& ring : rings) {
        responses.push_back(response_of(ring));
        ring.weight = 1 / double(rings.size());
    }
    Response error = truth;
    for (double& e : error) e = -e;
    for (size_t r = 0; r < rings.size(); ++r)
        for (size_t i = 0; i < error.size(); ++i) error[i] += rings[r].weight * responses[r][i];
    for (int round = 0; round < 200; ++round) {
        for (size_t from = 0; from < rings.size(); ++from)
            for (size_t to = 0; to < rings.size(); ++to) {
                double slope = 0, curvature = 0;
                for (size_t i = 0; i < error.size(); ++i) {
                    const double gain = responses[to][i] - responses[from][i];
                    slope += error[i] * gain;
                    curvature += gain * gain;
                }
                if (curvature < 1e-12) continue;
                const double moved = std::clamp(-slope / curvature, -rings[to].weight, rings[from].weight);
                rings[to].weight += moved;
                rings[from].weight -= moved;
                for (size_t i = 0; i < error.size(); ++i)
                    error[i] += moved * (responses[to][i] - responses[from][i]);
            }
    }
    return std::sqrt(std::inner_product(error.begin(), error.end(), error.begin(), 0.0) / lights);
}

/// Of those at least four fifths as wide as the widest: those of least error.
Rings uniform_rings(int count) {
    std::vector<Rings> all;
    std::vector<int> counts;
    for_each_split(count, counts, [&](const std::vector<int>& split) { all.push_back(equal(split)); });
    const auto half_angle = [](const Rings& rings) { return rings[0].half_angle; };
    const double widest = half_angle(std::ranges::max(all, {}, half_angle));
    std::erase_if(all, [&](const Rings& rings) { return half_angle(rings) < 0.8 * widest; });
    Rings best;
    double least = std::numeric_limits<double>::max();
    for (Rings& rings : all) {
        const double error = fit_weights(rings);
        if (error < least) {
            least = error;
            best = rings;
        }
    }
    return best;
}

/// Of the rings that fill from pole to horizon, that cover at least what uniform ones do, and none of whose circles is
/// more than twice as wide as another: those of least error.
Rings nonuniform_rings(int count) {
    const Rings uniform = uniform_rings(count);
    Rings best = uniform;
    double least = std::numeric_limits<double>::max();
    std::vector<int> counts;
    for_each_split(count, counts, [&](const std::vector<int>& split) {
        std::optional<Rings> rings = filling(split);
        if (!rings || coverage(*rings) < coverage(uniform) - 1e-6) return;
        const auto [narrowest, widest] = std::ranges::minmax_element(*rings, {}, &Ring::half_angle);
        if (widest->half_angle > 2 * narrowest->half_angle) return;
        const double error = fit_weights(*rings);
        if (error < least) {
            least = error;
            best = std::move(*rings);
        }
    });
    return best;
}

}  // namespace

Distribution distribute(const Settings& settings) {
    const int count = std::clamp(settings.count, 1, max_cones);
    const Rings rings =
        settings.apertures == Apertures::uniform ? uniform_rings(count) : nonuniform_rings(count);

    Distribution result;
    for (size_t r = 0; r < rings.size(); ++r) {
        const Ring& ring = rings[r];
        for (int i = 0; i < ring.cones; ++i) {
            // Half a step from ring to ring keeps cones from lining up.
            const double azimuth = glm::two_pi<double>() * (i + 0.5 * double(r % 2)) / ring.cones;
            result.cones.push_back(
                {.direction = glm::vec3(std::sin(ring.polar) * std::cos(azimuth),
                                        std::sin(ring.polar) * std::sin(azimuth), std::cos(ring.polar)),
                 .half_angle = float(std::min(ring.half_angle, glm::radians(75.0))),
                 .weight = float(ring.weight / ring.cones)});
        }
    }
    return result;
}

Distribution distribute_in_pattern(const Settings& settings) {
    const int count = std::clamp(settings.count, 1, max_cones);
    // Circles that do not overlap cover about this much. The narrower they are the more they see of what is small and the
    // less what stands in part of a cone hides of the rest; gaps between the cones of a place, the other places fill.
    constexpr double covered = 0.75, narrower = 4;
    const double share = covered / (narrower * count);  // of the hemisphere
    const int all = places * count;
    Distribution result{.cones = {}, .sets = places};
    for (int place = 0; place < places; ++place)
        for (int i = 0; i < count; ++i) {
            const int index = i * places + place;
            const double squared_sine = (index + 0.5) / all, cosine = std::sqrt(1 - squared_sine);
            // Of rings of the same irradiance, the room grows as their cosine falls; its mean is that at 1/2.
            const double room =
                settings.apertures == Apertures::uniform ? 1 : std::clamp(0.5 / cosine, 0.25, 4.0);
            const double half_angle = std::acos(1 - share * room);
            const double polar = std::min(std::acos(cosine), horizon - half_angle);
            constexpr double golden_angle = 2.399963229728653;
            const double azimuth = golden_angle * index;
            result.cones.push_back(
                {.direction = glm::vec3(std::sin(polar) * std::cos(azimuth),
                                        std::sin(polar) * std::sin(azimuth), std::cos(polar)),
                 .half_angle = float(half_angle),
                 .weight = 1 / float(count)});
        }
    return result;
}

Distribution distribution_of(const Settings& settings) {
    return settings.turned ? distribute_in_pattern(settings) : distribute(settings);
}

DirectionalError directional_error(const Distribution& distribution) {
    // A disk's estimate is its integral of the kernel: at each direction, the sum of weight over solid angle of the
    // cones that hold it. The truth's kernel is the cosine.
    struct Sample {
        glm::dvec3 direction;
        double kernel = 0;
    };
    constexpr int rows = 48, columns = 96, light_rows = 16, light_columns = 32;
    const double cosine_of_disk = std::cos(glm::radians(30.0));
    const auto direction = [](double z, double azimuth) {
        const double sine = std::sqrt(1 - z * z);
        return glm::dvec3(sine * std::cos(azimuth), sine * std::sin(azimuth), z);
    };
    std::vector<Sample> samples;
    for (int row = 0; row < rows; ++row)
        for (int column = 0; column < columns; ++column) {
            Sample sample{direction((row + 0.5) / rows, glm::two_pi<double>() * (column + 0.5) / columns)};
            for (const Cone& cone : distribution.cones) {
                const double cosine = std::cos(double(cone.half_angle));
                if (glm::dot(sample.direction, glm::dvec3(cone.direction)) >= cosine)
                    sample.kernel += double(cone.weight) / (distribution.sets * 2 * (1 - cosine));
            }
            samples.push_back(sample);
        }
    const auto irradiance_of = [&](const glm::dvec3& light) {
        double estimate = 0, truth = 0;
        for (const Sample& sample : samples) {
            if (glm::dot(sample.direction, light) < cosine_of_disk) continue;
            estimate += sample.kernel;
            truth += sample.direction.z;
        }
        return glm::dvec2(estimate, truth);
    };

    const glm::dvec2 at_zenith = irradiance_of({0, 0, 1});
    DirectionalError result{.zenith = at_zenith.x / at_zenith.y - 1};
    double squares = 0, truth = 0;
    int count = 0;
    const auto add = [&](glm::dvec2 irradiance) {
        const double error = irradiance.x - irradiance.y;
        squares += error * error;
        result.max = std::max(result.max, std::abs(error));
        truth += irradiance.y;
        ++count;
    };
    for (int row = 0; row <= light_rows; ++row) {
        glm::dvec2 mean(0);
        for (int column = 0; column < light_columns; ++column) {
            const glm::dvec2 irradiance = irradiance_of(
                direction(double(row) / light_rows, glm::two_pi<double>() * column / light_columns));
            mean += irradiance / double(light_columns);
            add(irradiance);
        }
        if (row == 0) result.horizon = mean.x / mean.y - 1;
    }
    truth /= count;
    result.rms = std::sqrt(squares / count) / truth;
    result.max /= truth;
    return result;
}

}  // namespace lumo::cones
