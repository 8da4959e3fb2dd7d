// A report as one page that needs no other file.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "samples/lumo/report/findings.hpp"

namespace lumo::program {

/// Text as it stands in HTML, in and out of attributes: one line, without control characters.
std::string escaped(std::string_view text);

/// HTML. Plots are taken from the folder; where there are none the page says `without_plots`.
std::string page_of(const Findings& findings, const std::filesystem::path& folder,
                    const std::string& without_plots);

}  // namespace lumo::program
