// Text from files, made safe to show.
#pragma once

#include <string>
#include <string_view>

namespace lumo::scene {

/// The text as one line that a terminal shows and does not obey: control characters (C0, C1, DEL), invalid
/// UTF-8 and Unicode's direction overrides become '?'; beyond max_bytes it ends in "…".
std::string printable(std::string_view text, size_t max_bytes = 200);

}  // namespace lumo::scene
