// What is said while the program works, on the standard error.
#pragma once

#include <string_view>

namespace lumo::program {

/// Messages go through spdlog, as "lumo: LEVEL: text"; `quiet` leaves warnings and errors.
void start_messages(bool quiet);

/// A bar of steps while it lives; nothing where the standard error is no terminal, or if quiet.
class Progress {
  public:
    Progress(int steps, bool quiet);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    /// The step before is done, and this one begins.
    void next(std::string_view what);
    /// Takes the bar away, until the next step, for what goes to the standard output.
    void clear();

  private:
    int steps_;
    int begun_ = 0;
    bool shown_;
};

}  // namespace lumo::program
