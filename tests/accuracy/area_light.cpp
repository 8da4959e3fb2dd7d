// The paper's case for high dynamic range: a small emitter far above what eight bits hold lights coloured walls.
#include <cmath>
#include <gtest/gtest.h>
#include <map>

#include "scene/builtin/builtin.hpp"
#include "techniques/frame/render.hpp"
#include "tests/support/device_test.hpp"
#include "tests/support/rendering.hpp"

namespace lumo {
namespace {

using namespace testing_support;
using voxels::Range;

using AreaLightTest = DeviceTest;
INSTANTIATE_TEST_SUITE_P(Accuracy, AreaLightTest, both_apis, api_name);

/// Root mean square of the difference over the mean.
double relative_rmse(const scene::ImageF& a, const scene::ImageF& b) {
    double squares = 0, sum = 0;
    for (size_t i = 0; i < a.values.size(); ++i) {
        squares += std::pow(double(a.values[i]) - double(b.values[i]), 2);
        sum += double(b.values[i]);
    }
    const double count = double(a.values.size());
    return std::sqrt(squares / count) / (sum / count);
}

double mean(const scene::ImageF& image) {
    double sum = 0;
    for (const float value : image.values) sum += double(value);
    return sum / double(image.values.size());
}

TEST_P(AreaLightTest, EightBitsLoseItAndTheWideRangesAgree) {
    const scene::Scene scene = value_of(scene::make_builtin("area-light"));
    std::map<Range, scene::ImageF> indirect;
    for (const Range range : voxels::all_ranges) {
        frame::Settings settings{.size = {40, 30}, .layers = {frame::Layer::indirect}, .range = range};
        settings.voxels.resolution = 32;
        frame::Rendered rendered =
            must(frame::render(device(), scene, scene::default_camera(scene), settings));
        indirect[range] = std::move(rendered.layers[0].linear);
    }
    const scene::ImageF& fixed = indirect[Range::fixed];
    EXPECT_GT(mean(fixed), 0.01);
    for (const Range a : {Range::mutex, Range::rgbe, Range::fixed})
        for (const Range b : {Range::mutex, Range::rgbe, Range::fixed})
            EXPECT_LE(relative_rmse(indirect[a], indirect[b]), 0.01) << to_string(a) << ", " << to_string(b);
    // The lamp has radiance 10 and counts as 1.
    for (const Range range : {Range::ldr, Range::average})
        EXPECT_LT(mean(indirect[range]), 0.2 * mean(fixed)) << to_string(range);
}

}  // namespace
}  // namespace lumo
