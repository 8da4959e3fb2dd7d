// The subcommands. Each returns the program's exit code, or why it could not do its work.
#pragma once

#include <string>

#include "samples/lumo/options.hpp"

namespace lumo::program {

Result<int> render(const Options& options);
Result<int> check(const Options& options);
Result<int> diff(const Options& options);
Result<int> devices(const Options& options);
Result<int> bench(const Options& options);
Result<int> report(const Options& options);
Result<int> tune(const Options& options);
Result<int> probe(const Options& options);

/// The build, and the devices with their drivers.
std::string version_text();

}  // namespace lumo::program
