// lumo: real-time global illumination from the command line.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "samples/lumo/commands.hpp"
#include "samples/lumo/options.hpp"
#include "samples/lumo/progress.hpp"

namespace lumo::program {
namespace {

Result<int> run(const Options& options) {
    switch (options.command) {
        case Command::render:
            return render(options);
        case Command::check:
            return check(options);
        case Command::diff:
            return diff(options);
        case Command::devices:
            return devices(options);
        case Command::bench:
            return bench(options);
        case Command::report:
            return report(options);
        case Command::tune:
            return tune(options);
        case Command::probe:
            return probe(options);
        case Command::version:
            break;
    }
    fmt::print("{}", version_text());
    return exit_done;
}

/// That there was no room for what was printed shows itself only here.
Result<int> flushed(int exit_code) {
    if (std::fflush(stdout) == 0 && !std::ferror(stdout)) return exit_code;
    return fail(ErrorKind::io, "standard output", "cannot be written", "check that it has room");
}

int run(int argc, const char* const* argv) {
    const auto options = parse_options(argc, argv);
    if (!options) {
        fmt::print(options.error().exit_code == exit_done ? stdout : stderr, "{}\n", options.error().text);
        return options.error().exit_code;
    }
    start_messages(options->quiet);
    const Result<int> exit_code = run(*options).and_then(flushed);
    if (exit_code) return *exit_code;
    spdlog::error("{}", to_string(exit_code.error()));
    return exit_failed;
}

}  // namespace
}  // namespace lumo::program

int main(int argc, char** argv) {
    try {
        return lumo::program::run(argc, argv);
    } catch (const std::bad_alloc&) {
        fmt::print(stderr, "lumo: error: out of memory\n");
    } catch (const std::exception& error) {
        fmt::print(stderr, "lumo: error: {}\n", error.what());
    }
    return lumo::program::exit_failed;
}
