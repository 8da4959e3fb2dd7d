// What a report found as data.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "samples/lumo/report/findings.hpp"

namespace lumo::program {

/// Everything but the pictures.
nlohmann::ordered_json to_json(const Findings& findings);

/// A line of names, then one per configuration and device, as RFC 4180 has them but with line feeds alone. What was not
/// measured is empty.
std::string to_csv(const Findings& findings);

/// Likewise one line per preset of the sky's tables and device; empty where the scene has no sky.
std::string sky_csv(const Findings& findings);

}  // namespace lumo::program
