#include "samples/lumo/progress.hpp"

#include <algorithm>
#include <cstdio>
#include <fmt/format.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

namespace lumo::program {
namespace {

bool on_terminal() { return isatty(STDERR_FILENO) != 0; }

constexpr const char* erase_line = "\r\033[K";

}  // namespace

void start_messages(bool quiet) {
    spdlog::set_default_logger(spdlog::stderr_logger_st("lumo"));
    // A message takes the place of the bar, which the next step draws again.
    spdlog::set_pattern(on_terminal() ? std::string(erase_line) + "lumo: %l: %v" : "lumo: %l: %v");
    spdlog::set_level(quiet ? spdlog::level::warn : spdlog::level::info);
}

Progress::Progress(int steps, bool quiet) : steps_(std::max(steps, 1)), shown_(on_terminal() && !quiet) {}

Progress::~Progress() { clear(); }

void Progress::clear() {
    if (!shown_) return;
    fmt::print(stderr, "{}", erase_line);
    std::fflush(stderr);
}

void Progress::next(std::string_view what) {
    constexpr int width = 24;
    const int done = std::min(begun_++, steps_) * width / steps_;
    if (!shown_) return;
    fmt::print(stderr, "{}[{:=>{}}{:>{}}] {}", erase_line, "", done, "", width - done, what);
    std::fflush(stderr);
}

}  // namespace lumo::program
