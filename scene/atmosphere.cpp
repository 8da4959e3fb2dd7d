#include "scene/atmosphere.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>
#include <span>

#include "scene/file.hpp"
#include "scene/printable.hpp"

namespace lumo::scene {
namespace {

using Json = nlohmann::json;

constexpr size_t most_wavelengths = 64;
constexpr uint64_t largest_file = uint64_t(1) << 20;  // bytes
constexpr double largest_radius = 1e6;  // km; beyond it double precision no longer resolves a millimetre

/// Keeps the first error of many steps.
class Checker {
  public:
    Checker(std::string_view subject, ErrorKind kind) : subject_(subject), kind_(kind) {}

    void require(bool holds, const std::string& message, const std::string& remedy) {
        if (!holds && !error_) error_ = Error{kind_, subject_, message, remedy};
    }
    void in_range(const std::string& field, double value, double lowest, double highest) {
        require(value >= lowest && value <= highest, fmt::format("{} is {}", field, value),
                fmt::format("give a number from {:g} to {:g}", lowest, highest));
    }
    void in_range(const std::string& field, const Spectrum& values, size_t size, double lowest,
                  double highest) {
        require(values.size() == size, fmt::format("{} has {} values", field, values.size()),
                fmt::format("give {}, one for each of wavelengths_nm", size));
        for (size_t i = 0; i < values.size(); ++i)
            in_range(fmt::format("{}[{}]", field, i), values[i], lowest, highest);
    }
    bool failed() const { return error_.has_value(); }
    Result<void> result() const {
        if (error_) return tl::unexpected(*error_);
        return {};
    }

  private:
    std::string subject_;
    ErrorKind kind_;
    std::optional<Error> error_;
};

/// An object of a JSON file, whose members are asked for by name.
class Object {
  public:
    Object(const Json& json, std::string path, std::span<const std::string_view> known, Checker& checker)
        : json_(json), path_(std::move(path)), checker_(checker) {
        checker.require(json.is_object(),
                        fmt::format("{} is {}", path_.empty() ? "the whole" : path_, shown(json)),
                        "give a JSON object");
        if (!json.is_object()) return;
        for (const auto& [key, value] : json.items()) {
            checker.require(std::ranges::find(known, std::string_view(key)) != known.end(),
                            fmt::format("there is no field '{}'", printable(name(key))),
                            fmt::format("known are {}", fmt::join(known, ", ")));
        }
    }

    const Json* find(const std::string& key) const {
        return json_.is_object() && json_.contains(key) && !json_[key].is_null() ? &json_[key] : nullptr;
    }
    double number(const std::string& key) const {
        const Json* value = required(key);
        return value ? number(*value, name(key)) : 0;
    }
    Spectrum spectrum(const std::string& key) const {
        Spectrum values;
        const Json* array = required(key);
        if (!array) return values;
        checker_.require(array->is_array() && array->size() <= most_wavelengths,
                         fmt::format("{} is {}", name(key), shown(*array)),
                         fmt::format("give an array of at most {} numbers", most_wavelengths));
        if (checker_.failed()) return values;
        for (size_t i = 0; i < array->size(); ++i)
            values.push_back(number((*array)[i], fmt::format("{}[{}]", name(key), i)));
        return values;
    }
    const Json* required(const std::string& key) const {
        const Json* value = find(key);
        checker_.require(value, fmt::format("{} is missing", name(key)), "add it");
        return value;
    }

  private:
    /// Arrays and objects by their kind alone: how deep they go is the file's choice.
    static std::string shown(const Json& json) {
        if (json.is_structured()) return fmt::format("an {}", json.type_name());
        return printable(json.dump(-1, ' ', false, Json::error_handler_t::replace), 60);
    }
    std::string name(const std::string& key) const { return path_.empty() ? key : path_ + "." + key; }
    double number(const Json& value, const std::string& field) const {
        checker_.require(value.is_number(), fmt::format("{} is {}", field, shown(value)), "give a number");
        return value.is_number() ? value.get<double>() : 0;
    }

    const Json& json_;
    std::string path_;
    Checker& checker_;
};

}  // namespace

Atmosphere earth() {
    return {
        .wavelengths_nm = {680, 550, 440},
        .sun_irradiance = {1.474, 1.8504, 1.91198},
        .rayleigh = RayleighSpecies{.scattering_per_km = {0.0058, 0.0136, 0.0331}},
        .mie = MieSpecies{.scattering_per_km = {0.003996, 0.003996, 0.003996},
                          .extinction_per_km = {0.00444, 0.00444, 0.00444}},
        .ozone = OzoneSpecies{.extinction_per_km = {0.00065, 0.00188, 0.000085}},
        .ground_albedo = {0.1, 0.1, 0.1},
    };
}

Result<void> check(const Atmosphere& a, std::string_view subject) {
    constexpr double most_per_km = 1e6, shortest_km = 1e-4;
    Checker checker(subject, ErrorKind::invalid_argument);
    const size_t size = a.wavelengths_nm.size();
    checker.require(size >= 1 && size <= most_wavelengths, fmt::format("wavelengths_nm has {} values", size),
                    fmt::format("give 1 to {}", most_wavelengths));
    checker.in_range("wavelengths_nm", a.wavelengths_nm, size, 1, 1e6);
    checker.in_range("radius_ground_km", a.radius_ground_km, 1e-3, largest_radius);
    checker.in_range("radius_top_km", a.radius_top_km, 1e-3, largest_radius);
    checker.require(a.radius_top_km > a.radius_ground_km, fmt::format("radius_top_km is {}", a.radius_top_km),
                    fmt::format("give more than radius_ground_km, {}", a.radius_ground_km));
    checker.in_range("sun.irradiance", a.sun_irradiance, size, 0, 1e12);
    checker.in_range("sun.angular_radius_deg", a.sun_angular_radius_deg, 0, 45);
    if (a.rayleigh) {
        checker.in_range("rayleigh.scattering_per_km", a.rayleigh->scattering_per_km, size, 0, most_per_km);
        checker.in_range("rayleigh.scale_height_km", a.rayleigh->scale_height_km, shortest_km,
                         largest_radius);
    }
    if (a.mie) {
        checker.in_range("mie.scattering_per_km", a.mie->scattering_per_km, size, 0, most_per_km);
        checker.in_range("mie.extinction_per_km", a.mie->extinction_per_km, size, 0, most_per_km);
        checker.in_range("mie.scale_height_km", a.mie->scale_height_km, shortest_km, largest_radius);
        checker.in_range("mie.g", a.mie->g, -0.999, 0.999);
        for (size_t i = 0; i < size && !checker.failed(); ++i)
            checker.require(a.mie->scattering_per_km[i] <= a.mie->extinction_per_km[i],
                            fmt::format("mie.scattering_per_km[{}] is {}", i, a.mie->scattering_per_km[i]),
                            fmt::format("give at most the extinction, {}", a.mie->extinction_per_km[i]));
    }
    if (a.ozone) {
        checker.in_range("ozone.extinction_per_km", a.ozone->extinction_per_km, size, 0, most_per_km);
        checker.in_range("ozone.bottom_km", a.ozone->bottom_km, 0, largest_radius);
        checker.in_range("ozone.peak_km", a.ozone->peak_km, 0, largest_radius);
        checker.in_range("ozone.top_km", a.ozone->top_km, 0, largest_radius);
        checker.require(a.ozone->bottom_km < a.ozone->peak_km && a.ozone->peak_km < a.ozone->top_km,
                        fmt::format("ozone.bottom_km, peak_km and top_km are {}, {} and {}",
                                    a.ozone->bottom_km, a.ozone->peak_km, a.ozone->top_km),
                        "give them in ascending order");
    }
    checker.in_range("ground_albedo", a.ground_albedo, size, 0, 1);
    return checker.result();
}

Result<Atmosphere> parse_atmosphere(std::string_view text, std::string_view subject) {
    static constexpr std::array<std::string_view, 8> all{
        "wavelengths_nm", "radius_ground_km", "radius_top_km", "sun", "rayleigh", "mie",
        "ozone",          "ground_albedo"};
    static constexpr std::array<std::string_view, 2> of_sun{"irradiance", "angular_radius_deg"};
    static constexpr std::array<std::string_view, 2> of_rayleigh{"scattering_per_km", "scale_height_km"};
    static constexpr std::array<std::string_view, 4> of_mie{"scattering_per_km", "extinction_per_km",
                                                            "scale_height_km", "g"};
    static constexpr std::array<std::string_view, 4> of_ozone{"extinction_per_km", "bottom_km", "peak_km",
                                                              "top_km"};

    const Json json = Json::parse(text, nullptr, false);
    if (json.is_discarded())
        return fail(ErrorKind::invalid_file, std::string(subject), "is not JSON",
                    "write it as a JSON object");
    Checker checker(subject, ErrorKind::invalid_file);
    const Object file(json, "", all, checker);
    Atmosphere a{.wavelengths_nm = file.spectrum("wavelengths_nm"),
                 .radius_ground_km = file.number("radius_ground_km"),
                 .radius_top_km = file.number("radius_top_km"),
                 .ground_albedo = file.spectrum("ground_albedo")};
    if (const Json* member = file.required("sun")) {
        const Object sun(*member, "sun", of_sun, checker);
        a.sun_irradiance = sun.spectrum("irradiance");
        a.sun_angular_radius_deg = sun.number("angular_radius_deg");
    }
    if (const Json* member = file.find("rayleigh")) {
        const Object species(*member, "rayleigh", of_rayleigh, checker);
        a.rayleigh = RayleighSpecies{.scattering_per_km = species.spectrum("scattering_per_km"),
                                     .scale_height_km = species.number("scale_height_km")};
    }
    if (const Json* member = file.find("mie")) {
        const Object species(*member, "mie", of_mie, checker);
        a.mie = MieSpecies{.scattering_per_km = species.spectrum("scattering_per_km"),
                           .extinction_per_km = species.spectrum("extinction_per_km"),
                           .scale_height_km = species.number("scale_height_km"),
                           .g = species.number("g")};
    }
    if (const Json* member = file.find("ozone")) {
        const Object species(*member, "ozone", of_ozone, checker);
        a.ozone = OzoneSpecies{.extinction_per_km = species.spectrum("extinction_per_km"),
                               .bottom_km = species.number("bottom_km"),
                               .peak_km = species.number("peak_km"),
                               .top_km = species.number("top_km")};
    }
    return checker.result().and_then([&] { return check(a, subject); }).map([&] { return a; });
}

Result<Atmosphere> load_atmosphere(const std::filesystem::path& file) {
    return read_file(file, largest_file).and_then([&](const std::vector<std::byte>& bytes) {
        const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        return parse_atmosphere(text, printable(file.string()));
    });
}

}  // namespace lumo::scene
