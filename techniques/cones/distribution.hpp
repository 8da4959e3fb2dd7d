// Cones that share out a hemisphere.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace lumo::cones {

inline constexpr int max_cones = 32;

struct Cone {
    glm::vec3 direction{0, 0, 1};  ///< unit length, about +z
    float half_angle = 0;          ///< radians
    float weight = 1;              ///< share of the irradiance of a constant environment; all add to 1
};

/// `uniform`: all cones are as wide. `nonuniform`: those of a ring are, and rings fill what is between the pole and the
/// horizon. At three cones both are the same.
enum class Apertures : uint8_t { uniform, nonuniform };

/// The cones, on concentric rings: circles packed on the hemisphere after Appelbaum & Weiss (1999), which touch, do not
/// overlap and stay above the horizon. Cones are traced as wide as their circles: wider ones would meet the surface that
/// they start from. At most 75 degrees to a side, which only one cone reaches.
struct Distribution {
    std::vector<Cone> cones;
    int sets = 1;  ///< of as many cones each, one set after the other
};

/// The cones of a ring weigh the same. Weights add to 1, so a constant environment gives
/// exactly its irradiance; within that they are those, none negative, that come nearest to the cosine's zonal harmonics
/// 1 and 2, as seen through cones of their widths.
struct Settings {
    int count = 9;  ///< 1 to max_cones; what is beyond counts as these
    Apertures apertures = Apertures::uniform;
    bool turned = true;  ///< a set for each place of a pattern, in place of one for all
};
/// One set for all places.
Distribution distribute(const Settings& settings);

/// The places of a 4 x 4 pattern of pixels or voxels.
inline constexpr int places = 16;

/// A set of cones for each of `places`. The cones of all are one spiral of golden angles about the normal, one in each of as
/// many rings of the same share of a constant environment's irradiance; each place has every 16th, and all of its cones
/// weigh the same. Each is as wide as a circle of four times as many that share the hemisphere; nonuniform: as many times
/// as it has more room than others, at most twice as wide. None goes below the horizon.
Distribution distribute_in_pattern(const Settings& settings);

/// The one that Settings::turned says.
Distribution distribution_of(const Settings& settings);

/// How far a set's irradiance is from the cosine law, for a distant disk of light of 30 degrees to a side: (estimate -
/// truth) / truth, without what a surface would hide. Each cone takes the mean radiance of its solid angle; of several sets
/// the mean counts. The disk's centre is at the zenith, at the horizon, or anywhere in steps of zenith angle and azimuth.
struct DirectionalError {
    double zenith = 0;
    double horizon = 0;  ///< mean over azimuth
    double rms = 0;      ///< over directions of equal solid angle
    double max = 0;      ///< largest magnitude
};
DirectionalError directional_error(const Distribution& distribution);

}  // namespace lumo::cones
