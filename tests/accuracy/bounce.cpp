// Light between the walls of a closed box, whose sum over bounces is known: where every wall emits Le and reflects
// rho of what it receives, irradiance is pi Le (1 + rho + … + rho^n) everywhere after n bounces.
#include <fmt/format.h>
#include <glm/gtc/constants.hpp>
#include <gtest/gtest.h>

#include "techniques/frame/render.hpp"
#include "tests/support/device_test.hpp"
#include "tests/support/voxels.hpp"

namespace lumo {
namespace {

using namespace testing_support;

constexpr float emitted = 2;

scene::Scene closed_box(float albedo) {
    scene::Scene scene;
    add(scene, scene::builtin::reversed(scene::builtin::box(glm::vec3(-1), glm::vec3(1))),
        diffuse(glm::vec3(albedo), glm::vec3(emitted)));
    scene.cameras.push_back(
        {.position = {0.1f, 0.05f, 0.15f}, .target = {-1, -0.7f, -1}, .vertical_fov = 1.8f});
    return scene;
}

struct Spread {
    double least = 1e30;
    double mean = 0;
    double greatest = 0;
};

struct BounceTest : DeviceTest {
    /// Irradiance at pixels over pi Le.
    Spread irradiance(float albedo, uint32_t bounces, uint32_t resolution = 32,
                      voxels::MipKind mips = voxels::MipKind::anisotropic) {
        const scene::Scene scene = closed_box(albedo);
        frame::Settings settings{.size = {32, 24},
                                 .diffuse_materials = true,
                                 .bounces = bounces,
                                 .layers = {frame::Layer::irradiance, frame::Layer::depth}};
        settings.voxels = {.resolution = resolution, .mips = mips};
        const frame::Rendered rendered =
            must(frame::render(device(), scene, scene::default_camera(scene), settings));
        Spread spread;
        const scene::ImageF& picture = rendered.layers[0].linear;
        for (uint32_t y = 0; y < picture.height; ++y)
            for (uint32_t x = 0; x < picture.width; ++x) {
                EXPECT_GT(*rendered.layers[1].linear.at(x, y), 0);
                const double e = double(*picture.at(x, y)) / (glm::pi<double>() * double(emitted));
                spread.least = std::min(spread.least, e);
                spread.greatest = std::max(spread.greatest, e);
                spread.mean += e / (picture.width * picture.height);
            }
        return spread;
    }
};
INSTANTIATE_TEST_SUITE_P(Accuracy, BounceTest, both_apis, api_name);

/// A gather loses light, because a wall of coarse voxels does not quite stop the cones that meet it at an angle, and
/// must not make any. Of every bounce at least `kept` arrives, so that irradiance lies between the sum of (kept rho)^i kept and the sum of rho^i.
void expect_series(const Spread& irradiance, double albedo, uint32_t bounces, double kept) {
    double least = 0, exact = 0;
    for (uint32_t i = 0; i <= bounces; ++i) {
        least += std::pow(albedo, i) * std::pow(kept, i + 1);
        exact += std::pow(albedo, i);
    }
    EXPECT_GE(irradiance.mean, least) << "of " << exact;
    EXPECT_LE(irradiance.mean, 1.01 * exact);
    EXPECT_LE(irradiance.greatest, 1.05 * exact);
}

TEST_P(BounceTest, ClosedBoxIsTheGeometricSeries) {
    constexpr double kept = 0.85;
    for (const auto& [albedo, bounces] :
         {std::pair(0.0f, 1u), std::pair(0.8f, 1u), std::pair(0.8f, 2u), std::pair(0.8f, 4u)}) {
        SCOPED_TRACE(fmt::format("albedo {}, {} bounces", albedo, bounces));
        const Spread s = irradiance(albedo, bounces);
        RecordProperty(fmt::format("irradiance_{}_{}", int(10 * albedo), bounces),
                       fmt::format("{:.4f}", s.mean));
        expect_series(s, double(albedo), bounces, kept);
        EXPECT_GT(s.least, 0.75 * s.mean);
    }
}

TEST_P(BounceTest, ConvergesWithoutGainingLight) {
    constexpr float albedo = 0.99f;
    double before = 0, step_before = 1e30;
    for (const uint32_t bounces : {1u, 2u, 3u, 4u}) {
        const Spread s = irradiance(albedo, bounces, 16);
        expect_series(s, double(albedo), bounces, 0.82);
        EXPECT_GT(s.mean, before);
        if (bounces > 1) {
            EXPECT_LT(s.mean - before, step_before);
            step_before = s.mean - before;
        }
        before = s.mean;
    }
    const Spread many = irradiance(albedo, 20, 16), more = irradiance(albedo, 30, 16);
    EXPECT_LT(more.greatest, 1 / (1 - double(albedo)));
    EXPECT_GE(more.mean, many.mean);
    EXPECT_LT(more.mean - many.mean, 0.5 * (many.mean - before));
}

}  // namespace
}  // namespace lumo
