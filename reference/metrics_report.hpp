// A comparison of two pictures as text and as JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "reference/metrics.hpp"

namespace lumo::reference {

/// A table of figures, then the worst misses of the parity, at most as many as asked for.
std::string to_text(const Comparison& comparison, size_t max_misses = 10);

/// The members of Comparison by their names; null where a number is not finite.
nlohmann::ordered_json to_json(const Comparison& comparison);

}  // namespace lumo::reference
