#include "samples/lumo/probe_sky.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glm/glm.hpp>

#include "samples/lumo/values.hpp"
#include "scene/printable.hpp"
#include "scene/sky.hpp"

namespace lumo::program {
namespace {

using atmosphere::Question;

/// A column of numbers.
struct Input {
    std::string_view column;
    double lowest, highest;
    double Question::*place;
    /// Those that do not depend on it.
    std::array<bool, sky_quantities.size()> unread;
};

constexpr double farthest_km = 1e7;

// Columns by sky_quantities.
constexpr std::array<Input, 5> inputs{
    {{"camera_alt_km", 0, 1e6, &Question::altitude_km, {}},
     {"view_zenith_deg", 0, 180, &Question::view_zenith_deg, {false, false, false, false, false, true, true}},
     {"sun_zenith_deg", 0, 180, &Question::sun_zenith_deg, {true, true}},
     {"rel_azimuth_deg", -360, 360, &Question::azimuth_deg, {true, true, false, false, false, true, true}},
     {"distance_km", 0, farthest_km, &Question::distance_km, {true, false, true, true, false, true, true}}}};

std::string place_of(std::string_view file, const Table::Row& row, std::string_view column) {
    return fmt::format("{}, line {}, column {}", file, row.line, column);
}

}  // namespace

Result<std::vector<Question>> read_sky_questions(const Table& table, std::string_view file) {
    const auto missing = [&](std::string_view column) {
        return fail(ErrorKind::invalid_file, std::string(file), fmt::format("has no column {}", column),
                    "add it; the columns have their names in the first line");
    };
    const auto quantity_column = table.column("quantity");
    if (!quantity_column) return missing("quantity");

    std::vector<Question> questions;
    for (const Table::Row& row : table.rows) {
        const std::string& name = row.cells[*quantity_column];
        const auto* const found = std::ranges::find(sky_quantities, name);
        if (found == sky_quantities.end())
            return fail(ErrorKind::invalid_file, place_of(file, row, "quantity"),
                        fmt::format("'{}' is no quantity", scene::printable(name)),
                        fmt::format("available: {}", fmt::join(sky_quantities, ", ")));
        const auto index = size_t(found - sky_quantities.begin());
        Question question{.quantity = atmosphere::Quantity(index)};
        for (const Input& input : inputs) {
            if (input.unread[index]) continue;
            const auto column = table.column(input.column);
            if (!column) return missing(input.column);
            const std::string& cell = row.cells[*column];
            const auto number = parse_number(cell);
            if (!number || *number < input.lowest || *number > input.highest)
                return fail(ErrorKind::invalid_file, place_of(file, row, input.column),
                            fmt::format("is '{}'", scene::printable(cell)),
                            fmt::format("give a number from {:g} to {:g}", input.lowest, input.highest));
            question.*input.place = *number;
        }
        questions.push_back(question);
    }
    return questions;
}

Result<void> add_sky_answers(Table& table, std::span<const SkyAnswer> answers, std::string_view file) {
    const size_t before = table.columns.size();
    const size_t wavelengths = answers.empty() ? 0 : answers.front().value.size();
    const bool errors = std::ranges::any_of(answers, [](const SkyAnswer& a) { return !a.error.empty(); });
    for (const std::string_view name : {"value", "error"}) {
        if (name == "error" && !errors) break;
        for (size_t i = 0; i < wavelengths; ++i) {
            std::string column = fmt::format("{}_{}", name, i);
            if (table.column(column))
                return fail(ErrorKind::invalid_file, std::string(file),
                            fmt::format("has a column {} already", column), "rename it, or leave it out");
            table.columns.push_back(std::move(column));
        }
    }
    for (size_t r = 0; r < answers.size(); ++r) {
        std::vector<std::string>& cells = table.rows[r].cells;
        for (const scene::Spectrum* values : {&answers[r].value, &answers[r].error})
            for (const double value : *values) cells.push_back(fmt::format("{}", value));
        cells.resize(before + wavelengths * (errors ? 2 : 1));
    }
    return {};
}

Result<void> add_sky_luminance(Table& table, std::span<const Question> questions,
                               std::span<const SkyAnswer> answers, const scene::Spectrum& wavelengths_nm,
                               std::string_view file) {
    constexpr std::string_view column = "luminance";
    if (table.column(column))
        return fail(ErrorKind::invalid_file, std::string(file),
                    fmt::format("has a column {} already", column), "rename it, or leave it out");
    table.columns.emplace_back(column);
    constexpr double lumens_per_watt = 683;
    const glm::dvec3 of_rec709(0.2126390, 0.7151687, 0.0721923);
    const std::vector<glm::dvec3> weights = scene::rgb_weights(wavelengths_nm);
    for (size_t r = 0; r < answers.size(); ++r) {
        const bool light = questions[r].quantity != atmosphere::Quantity::transmittance_to_space &&
                           questions[r].quantity != atmosphere::Quantity::transmittance_segment;
        double sum = 0;
        for (size_t i = 0; i < weights.size(); ++i)
            sum += lumens_per_watt * glm::dot(of_rec709, weights[i]) * answers[r].value[i];
        table.rows[r].cells.push_back(light ? fmt::format("{}", sum) : std::string());
    }
    return {};
}

}  // namespace lumo::program
