// What a loader has to say beside its result.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

namespace lumo::scene::gltf {

/// Warnings, each said once; a file with many faults does not get to say them all.
class Warnings {
  public:
    void add(std::string text) {
        if (std::ranges::find(lines_, text) != lines_.end()) return;
        if (lines_.size() < max_lines)
            lines_.push_back(std::move(text));
        else
            ++left_out_;
    }

    std::vector<std::string> take() {
        if (left_out_ > 0) lines_.push_back("and " + std::to_string(left_out_) + " warnings more");
        return std::move(lines_);
    }

  private:
    static constexpr size_t max_lines = 64;

    std::vector<std::string> lines_;
    uint64_t left_out_ = 0;
};

}  // namespace lumo::scene::gltf
