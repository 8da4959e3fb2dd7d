// Light of many orders in an atmosphere by guided paths, for answers with little noise.
#pragma once

#include "reference/atmosphere_guide.hpp"
#include "reference/atmosphere_light.hpp"

namespace lumo::reference {

/// What radiance() and sky_irradiance() of atmosphere_light.hpp estimate by plain paths, to the same error in a fiftieth
/// of the time where the sun is low: sunlight is integrated along each ray by a Comb instead of asked for at one point;
/// rays go on from a point of the comb, in proportion to the light that arrives there, toward where it comes from
/// (LightGuide); and samples have low discrepancy. Making one takes half a second. Objects do not change: any number of
/// threads may ask.
class GuidedPaths {
  public:
    /// Keeps a reference to `optics`.
    explicit GuidedPaths(const AtmosphereOptics& optics);

    /// Samples are those of 16 streams of Sampler, of as many each as a power of two allows; the error is that of the
    /// mean of their means.
    Estimate radiance(const SkyView& view, const PathSettings& settings) const;
    Estimate sky_irradiance(const SkyView& view, const PathSettings& settings) const;

  private:
    const AtmosphereOptics& optics_;
    ColumnTable columns_;
    LightGuide guide_;
};

}  // namespace lumo::reference
