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

/// Of each device error against time, time by pass and memory by resource.
std::vector<Plot> plots_of(const Findings& findings);

/// What gnuplot has to do for them, run in the folder.
std::string gnuplot_script(const Findings& findings);

/// Runs gnuplot (found by PATH) with a script of that folder. Errors: unsupported if there is none, io if it fails.
Result<void> run_gnuplot(const std::filesystem::path& folder, const std::string& script);

}  // namespace lumo::program
