// Runs the program and reads what it wrote.
#pragma once

#include <filesystem>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "scene/image.hpp"

namespace lumo::test {

using Arguments = std::vector<std::string>;
using Environment = std::vector<std::pair<std::string, std::string>>;

struct Outcome {
    int exit_code = -1;  ///< -1 where a signal ended it
    std::string out, err;
};

/// Tests in a folder of their own, in which the program runs, with the validation layers on.
class Program : public testing::Test {
  protected:
    void SetUp() override;
    void TearDown() override;

    Outcome lumo(const Arguments& arguments, const Environment& environment = {}) const;
    /// The same, and fails the test unless all was done.
    Outcome done(const Arguments& arguments) const;

    std::filesystem::path path(const std::string& name) const { return folder_ / name; }
    void write(const std::string& name, const std::string& text) const;
    nlohmann::json json(const std::string& name) const;
    scene::Image8 png(const std::string& name) const;
    std::vector<scene::ExrLayer> exr(const std::string& name) const;
    std::string bytes(const std::string& name) const;

  private:
    std::filesystem::path folder_;
};

/// The same on one API after the other.
class ProgramOnApi : public Program, public testing::WithParamInterface<const char*> {};

/// A file or folder of the shared data; may be absent.
inline std::filesystem::path shared_data(const std::string& name) {
    return std::filesystem::path(LUMO_SHARED_DATA) / name;
}

/// The members of a glTF file in which accessor 0 is a triangle on the ground: (±4, 0, 0) and (0, 0, 2), its front up.
inline constexpr std::string_view triangle_accessor = R"(
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
                   "min": [-4, 0, 0], "max": [4, 0, 2]}],
    "bufferViews": [{"buffer": 0, "byteLength": 36}],
    "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64,)"
                                                      "AACAwAAAAAAAAAAAAAAAAAAAAAAAAABAAACAQAAAAAAAAAAA\"}]";

size_t lines(const std::string& text);
bool contains(const std::string& text, const std::string& part);

/// Mean of a channel over a rectangle given in parts of the picture, from the top left.
struct Part {
    double left = 0, top = 0, right = 1, bottom = 1;
};
template <class T>
double mean(const scene::Image<T>& image, const Part& part, uint32_t channel) {
    double sum = 0;
    uint64_t count = 0;
    for (auto y = uint32_t(part.top * image.height); y < uint32_t(part.bottom * image.height); ++y) {
        for (auto x = uint32_t(part.left * image.width); x < uint32_t(part.right * image.width); ++x, ++count)
            sum += double(image.at(x, y)[channel]);
    }
    return sum / double(count);
}

}  // namespace lumo::test
