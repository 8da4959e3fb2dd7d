// An atmosphere by its parameters: what scatters and absorbs light around a spherical planet.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "rhi/error.hpp"

namespace lumo::scene {

/// A value for each wavelength of an atmosphere.
using Spectrum = std::vector<double>;

/// Molecules: density exp(-altitude / scale height), no absorption.
struct RayleighSpecies {
    Spectrum scattering_per_km = {};  ///< at the ground, 0 and up
    double scale_height_km = 8;       ///< above 0
};

/// Aerosols: density exp(-altitude / scale height), the phase function of Cornette and Shanks.
struct MieSpecies {
    Spectrum scattering_per_km = {};  ///< at the ground, 0 up to the extinction
    Spectrum extinction_per_km = {};  ///< scattering and absorption
    double scale_height_km = 1.2;
    double g = 0.8;  ///< asymmetry of the Henyey-Greenstein lobe in it, between -1 and 1
};

/// A layer that absorbs alone: density 0 at its bottom, linear to 1 at its peak, linear to 0 at its top.
struct OzoneSpecies {
    Spectrum extinction_per_km = {};                   ///< at the peak
    double bottom_km = 10, peak_km = 25, top_km = 40;  ///< altitudes; bottom < peak < top
};

/// Bruneton and Neyret 2008, Precomputed Atmospheric Scattering, section 2.1, with ozone as in Bruneton's description
/// of 2017. All spectra are as long as wavelengths_nm. Air ends at radius_top_km; densities do not depend on what is
/// above it. A species may be absent.
struct Atmosphere {
    Spectrum wavelengths_nm = {};
    double radius_ground_km = 6360;
    double radius_top_km = 6420;
    Spectrum sun_irradiance = {};  ///< on a plane facing the sun above the air, W/m²/nm
    double sun_angular_radius_deg = 0.2678;
    std::optional<RayleighSpecies> rayleigh = {};
    std::optional<MieSpecies> mie = {};
    std::optional<OzoneSpecies> ozone = {};
    Spectrum ground_albedo = {};  ///< of a Lambertian ground, 0 to 1

    double height_km() const { return radius_top_km - radius_ground_km; }
};

/// At 680, 550 and 440 nm.
Atmosphere earth();

/// Every range above, equal lengths, and nothing that is not finite; at most 64 wavelengths. Errors: invalid_argument
/// with `subject` as subject; the message names field and value.
Result<void> check(const Atmosphere& atmosphere, std::string_view subject);

/// JSON: wavelengths_nm, radius_ground_km, radius_top_km, sun {irradiance, angular_radius_deg}, rayleigh, mie and ozone
/// (each may be missing or null) with their members' names, ground_albedo. All else must be there and nothing else may
/// be. Errors: invalid_file, and check()'s.
Result<Atmosphere> parse_atmosphere(std::string_view text, std::string_view subject);

/// The same from a file of at most 1 MiB. Errors: also io, limit.
Result<Atmosphere> load_atmosphere(const std::filesystem::path& file);

}  // namespace lumo::scene
