// Questions about the sky as rows of a table, and their answers as columns.
#pragma once

#include <array>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include "reference/atmosphere_light.hpp"
#include "samples/lumo/probe_table.hpp"

namespace lumo::program {

enum class SkyQuantity : uint8_t {
    transmittance_to_space,
    transmittance_segment,  ///< over the distance
    radiance,               ///< without what leaves the ground straight for the camera; W/m²/sr/nm
    radiance_order1,
    inscatter,       ///< the part of the radiance that is scattered within the distance
    sky_irradiance,  ///< on a horizontal plane, W/m²/nm
    sun_irradiance,  ///< likewise
};
inline constexpr std::array<std::string_view, 7> sky_quantities{
    "transmittance_to_space", "transmittance_segment", "radiance", "radiance_order1", "inscatter",
    "sky_irradiance",         "sun_irradiance"};

struct SkyQuery {
    SkyQuantity quantity = SkyQuantity::radiance;
    reference::SkyView view = {};  ///< at its defaults where the quantity does not depend on it
};

/// A value for each wavelength, and its standard error where it has one.
struct SkyAnswer {
    scene::Spectrum value = {};
    scene::Spectrum error = {};  ///< empty, or as long as value
};

/// From the columns quantity, camera_alt_km, view_zenith_deg, sun_zenith_deg, rel_azimuth_deg and distance_km, in any
/// order; other columns, and cells that a row's quantity does not depend on, are not read. Errors: invalid_file with
/// line, column, value and what it may be.
Result<std::vector<SkyQuery>> read_sky_queries(const Table& table, std::string_view file);

/// Adds the columns value_0 ..., and error_0 ... if any answer has an error. Errors: invalid_file where the table has
/// such a column.
Result<void> add_sky_answers(Table& table, std::span<const SkyAnswer> answers, std::string_view file);

/// How the reference answers.
struct SkyTruthSettings {
    uint32_t last_order = reference::all_orders;
    uint32_t samples = 1'000'000;   ///< at most, a row
    double relative_error = 0.002;  ///< of each wavelength's value: reached, no more paths are traced
};

/// In double precision: exact or converged quadrature, and Monte Carlo for orders from 2 on and for the irradiance of
/// the sky. A query's answer does not depend on the others. On every core; `answered` is told how many there are, in
/// the calling thread.
std::vector<SkyAnswer> sky_truth(const reference::AtmosphereOptics& optics, std::span<const SkyQuery> queries,
                                 const SkyTruthSettings& settings,
                                 const std::function<void(size_t)>& answered);

}  // namespace lumo::program
