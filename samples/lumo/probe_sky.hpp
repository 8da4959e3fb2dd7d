// Questions about the sky as rows of a table, and their answers as columns.
#pragma once

#include <array>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include "reference/atmosphere_light.hpp"
#include "samples/lumo/table.hpp"
#include "techniques/atmosphere/atmosphere.hpp"

namespace lumo::program {

/// By atmosphere::Quantity.
inline constexpr std::array<std::string_view, 7> sky_quantities{
    "transmittance_to_space", "transmittance_segment", "radiance", "radiance_order1", "inscatter",
    "sky_irradiance",         "sun_irradiance"};

/// A value for each wavelength, and its standard error where it has one.
struct SkyAnswer {
    scene::Spectrum value = {};
    scene::Spectrum error = {};  ///< empty, or as long as value
};

/// From the columns quantity, camera_alt_km, view_zenith_deg, sun_zenith_deg, rel_azimuth_deg and distance_km, in any
/// order; other columns, and cells that a row's quantity does not depend on, are not read. Errors: invalid_file with
/// line, column, value and what it may be.
Result<std::vector<atmosphere::Question>> read_sky_questions(const Table& table, std::string_view file);

/// Adds the columns value_0 ..., and error_0 ... if any answer has an error. Errors: invalid_file where the table has
/// such a column.
Result<void> add_sky_answers(Table& table, std::span<const SkyAnswer> answers, std::string_view file);

/// Adds the column luminance: of radiance in cd/m², of irradiance the illuminance in lx, by scene::rgb_weights over all
/// wavelengths at 683 lm/W; nothing for transmittance. Errors: as add_sky_answers.
Result<void> add_sky_luminance(Table& table, std::span<const atmosphere::Question> questions,
                               std::span<const SkyAnswer> answers, const scene::Spectrum& wavelengths_nm,
                               std::string_view file);

/// How the reference answers.
struct SkyTruthSettings {
    uint32_t last_order = reference::all_orders;
    uint32_t samples = 1'000'000;   ///< at most, a row
    double relative_error = 0.002;  ///< of each wavelength's value: reached, no more paths are traced
};

/// In double precision: exact or converged quadrature, and Monte Carlo for orders from 2 on and for the irradiance of
/// the sky. A question's answer does not depend on the others. On every core; `answered` is told how many there are, in
/// the calling thread.
std::vector<SkyAnswer> sky_truth(const reference::AtmosphereOptics& optics,
                                 std::span<const atmosphere::Question> questions,
                                 const SkyTruthSettings& settings,
                                 const std::function<void(size_t)>& answered);

/// By the programs that render pixels, with tables that are stored, or made and then stored. `progress` is told the
/// part done, 0 to 1. Errors: those of the device and of Tables::create.
Result<std::vector<SkyAnswer>> sky_on_device(rhi::Device& device, const scene::Atmosphere& atmosphere,
                                             const atmosphere::Settings& settings,
                                             std::span<const atmosphere::Question> questions,
                                             const std::function<void(double)>& progress);

}  // namespace lumo::program
