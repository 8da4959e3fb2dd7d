// A report's plots, which gnuplot draws.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "samples/lumo/report/findings.hpp"

namespace lumo::program {

struct Plot {
    std::string file;   ///< in the report's folder: .svg
    std::string title;  ///< of the page's section
};

/// Of each device error against time and time by pass; memory by resource of the first, as the others have next to the
/// same.
std::vector<Plot> plots_of(const Findings& findings);

/// What gnuplot has to do for them, run in the folder.
std::string gnuplot_script(const Findings& findings);

/// Runs gnuplot (found by PATH) with the script, a file of that folder, and takes out of the plots what shows nothing.
/// Errors: unsupported if there is no gnuplot, io if it fails.
Result<void> draw_plots(const Findings& findings, const std::filesystem::path& folder,
                        const std::string& script);

}  // namespace lumo::program
