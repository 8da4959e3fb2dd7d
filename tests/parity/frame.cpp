// Whole frames: OpenGL against Vulkan, and a plan against the plan that leaves nothing out.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <numeric>
#include <set>

#include "reference/metrics.hpp"
#include "scene/builtin/builtin.hpp"
#include "scene/sky.hpp"
#include "techniques/frame/render.hpp"
#include "tests/support/both_apis.hpp"

namespace lumo {
namespace {

using namespace testing_support;
using frame::Layer;

const std::vector<Layer> hdr_layers{Layer::radiance, Layer::direct,   Layer::indirect, Layer::irradiance,
                                    Layer::specular, Layer::emission, Layer::albedo,   Layer::normal,
                                    Layer::depth,    Layer::voxels,   Layer::ao};

frame::Settings settings_for(uint32_t voxels, uint32_t bounces = 1) {
    frame::Settings settings{.size = {160, 90}, .bounces = bounces, .layers = hdr_layers};
    settings.voxels.resolution = voxels;
    settings.shadow.resolution = 1024;
    return settings;
}

frame::Rendered render(rhi::Device& device, const scene::Scene& scene, const frame::Settings& settings) {
    return must(frame::render(device, scene, scene::default_camera(scene), settings));
}

struct FrameParityTest : BothApisTest {
    void expect_parity(const std::string& name, const frame::Settings& settings) {
        expect_parity(must(scene::make_builtin(name)), settings);
    }
    void expect_parity(const scene::Scene& scene, const frame::Settings& settings) {
        const std::string& name = scene.name;
        SCOPED_TRACE(name);
        const frame::Rendered a = render(gl(), scene, settings), b = render(vulkan(), scene, settings);
        ASSERT_EQ(a.layers.size(), settings.layers.size());
        for (size_t i = 0; i < a.layers.size(); ++i) {
            SCOPED_TRACE(to_string(a.layers[i].layer));
            if (a.layers[i].layer == Layer::final) {
                const scene::Image8 &x = a.layers[i].display, &y = b.layers[i].display;
                size_t beyond = 0;
                for (size_t j = 0; j < x.values.size(); ++j)
                    beyond += std::abs(x.values[j] - y.values[j]) > 1;
                EXPECT_LE(double(beyond), 1e-4 * x.width * x.height);
                continue;
            }
            const reference::Parity parity =
                must(reference::parity(a.layers[i].linear, b.layers[i].linear, reference::mesa_parity, 5));
            EXPECT_TRUE(parity.passed) << parity.pixels_beyond << " pixels beyond, worst "
                                       << parity.worst_times_bound << " times the bound";
            for (const reference::ParityMiss& miss : parity.misses)
                std::cout << fmt::format("{} {} at {}, {}: {} and {}, {} times the bound\n", name,
                                         to_string(a.layers[i].layer), miss.x, miss.y, miss.a, miss.b,
                                         miss.times_bound);
        }
    }
};

TEST_F(FrameParityTest, Cornell) { expect_parity("cornell", settings_for(32, 2)); }
TEST_F(FrameParityTest, AreaLight) { expect_parity("area-light", settings_for(32)); }
TEST_F(FrameParityTest, Furnace) { expect_parity("furnace", settings_for(32)); }
TEST_F(FrameParityTest, Atrium) {
    frame::Settings settings = settings_for(64);
    settings.layers.push_back(Layer::final);
    expect_parity("atrium", settings);
}
TEST_F(FrameParityTest, AtriumDiffuse) {
    frame::Settings settings = settings_for(32);
    settings.diffuse_materials = true;
    expect_parity("atrium", settings);
}

/// Rays meet the same voxels on both: with 16 a pixel and with one, in a volume and in an octree.
TEST_F(FrameParityTest, Rays) {
    for (const char* name : {"cornell", "atrium"})
        for (const auto& [storage, rays] :
             {std::pair(voxels::Storage::dense, 16u), std::pair(voxels::Storage::octree, 1u)}) {
            frame::Settings settings = settings_for(32, 2);
            settings.layers = {Layer::indirect, Layer::irradiance, Layer::specular};
            settings.voxels.storage = storage;
            settings.gatherer = frame::Gatherer::rays;
            settings.rays = rays;
            expect_parity(name, settings);
        }
}

/// The sun high, and below the horizon.
TEST_F(FrameParityTest, Sky) {
    frame::Settings settings = settings_for(32);
    settings.sky.tables = atmosphere::settings_of(atmosphere::Preset::fast);
    scene::Scene scene = must(scene::make_builtin("sky"));
    expect_parity(scene, settings);
    set_sky(scene, {.direction_to_sun = glm::normalize(glm::vec3(0.5f, -0.07f, -1))});
    for (scene::Material& material : scene.materials) {
        if (material.name != "white") continue;
        material.alpha_mode = scene::AlphaMode::blend;
        material.base_color.a = 0.5f;
    }
    settings.layers = {Layer::radiance, Layer::irradiance, Layer::specular};
    expect_parity(scene, settings);
}
TEST_F(FrameParityTest, AtriumUnderASky) {
    frame::Settings settings = settings_for(32);
    settings.layers = {Layer::radiance, Layer::irradiance, Layer::specular, Layer::final};
    settings.sky.tables = atmosphere::settings_of(atmosphere::Preset::fast);
    scene::Scene scene = must(scene::make_builtin("atrium"));
    set_sky(scene, {.direction_to_sun = -scene.lights.at(0).direction});
    expect_parity(scene, settings);
}

TEST_F(FrameParityTest, BarriersAreTheSame) {
    gl().set_tracing(true);
    vulkan().set_tracing(true);
    for (const auto& [name, plan] :
         {std::pair("cornell", frame::PlanMode::automatic), std::pair("atrium", frame::PlanMode::full)}) {
        SCOPED_TRACE(name);
        const scene::Scene scene = must(scene::make_builtin(name));
        frame::Settings settings = settings_for(16, 2);
        settings.size = {16, 16};
        settings.plan = plan;
        const frame::Rendered a = render(gl(), scene, settings), b = render(vulkan(), scene, settings);
        EXPECT_EQ(a.trace, b.trace);
        EXPECT_THAT(a.trace, testing::HasSubstr("voxels.voxelize"));
    }
}

/// Runs each test on both APIs.
struct FramePlanTest : DeviceTest {};
INSTANTIATE_TEST_SUITE_P(Frame, FramePlanTest, both_apis, api_name);

uint64_t bytes_of(const frame::Rendered& rendered) {
    return std::accumulate(rendered.memory.begin(), rendered.memory.end(), uint64_t(0),
                           [](uint64_t sum, const rhi::MemoryEntry& entry) { return sum + entry.bytes; });
}

std::set<std::string> pass_names(const frame::Rendered& rendered) {
    std::set<std::string> names;
    for (const rhi::PassTime& pass : rendered.passes) names.insert(pass.name);
    return names;
}

bool holds(const frame::Rendered& rendered, std::string_view resource) {
    for (const rhi::MemoryEntry& entry : rendered.memory)
        if (std::string_view(entry.name).substr(0, resource.size()) == resource) return true;
    return false;
}

TEST_P(FramePlanTest, FullPlanGivesTheSamePicture) {
    for (const char* name : {"cornell", "area-light", "atrium", "sky"}) {
        SCOPED_TRACE(name);
        const scene::Scene scene = must(scene::make_builtin(name));
        frame::Settings settings = settings_for(16, 2);
        settings.size = {64, 36};
        settings.sky.tables = atmosphere::settings_of(atmosphere::Preset::fast);
        settings.layers.push_back(Layer::final);
        const frame::Rendered automatic = render(device(), scene, settings);
        settings.plan = frame::PlanMode::full;
        const frame::Rendered full = render(device(), scene, settings);
        for (size_t i = 0; i < full.layers.size(); ++i) {
            SCOPED_TRACE(to_string(full.layers[i].layer));
            EXPECT_EQ(full.layers[i].display.values, automatic.layers[i].display.values);
            const auto &a = full.layers[i].linear.values, &b = automatic.layers[i].linear.values;
            ASSERT_EQ(a.size(), b.size());
            size_t different = 0;
            for (size_t j = 0; j < a.size(); ++j) different += std::memcmp(&a[j], &b[j], sizeof a[j]) != 0;
            EXPECT_EQ(different, 0u) << "of " << a.size();
        }
        EXPECT_GT(bytes_of(full), bytes_of(automatic));
        EXPECT_GE(full.passes.size(), automatic.passes.size());
    }
}

TEST_P(FramePlanTest, NothingOutsideThePlanIsRunOrHeld) {
    struct Absent {
        std::string item;
        std::vector<std::string> passes;
        std::vector<std::string> resources;
    };
    const Absent absences[] = {
        {"gbuffer.emission", {}, {"gbuffer.emission"}},
        {"shadow", {"shadow"}, {"shadow."}},
        {"voxels", {"voxels.clear", "voxels.voxelize", "voxels.resolve", "voxels.inject"}, {"voxels."}},
        {"voxels.emission",
         {"voxels.clear_emission", "voxels.voxelize_emission", "voxels.emission"},
         {"voxels.emission"}},
        {"voxels.light", {"voxels.light"}, {}},
        {"voxels.bounce", {"bounce"}, {"bounce."}},
        {"cones", {"cones.irradiance"}, {"cones.irradiance"}},
        {"cones.ao", {"cones.ao"}, {"cones.ao"}},
        {"sky.map", {"sky.map"}, {"sky.map"}},
        {"sky.pixels", {"sky.pixels"}, {"sky.radiance", "sky.transmittance"}},
        {"blend", {"lighting.blend"}, {}},
        {"post", {"post.display"}, {"post."}},
    };
    struct Case {
        std::string scene;
        bool gi;
        Layer layer;
    };
    std::set<std::string> tried;
    for (const Case& c : {Case{"cornell", true, Layer::radiance}, Case{"atrium", true, Layer::final},
                          Case{"furnace", true, Layer::final}, Case{"atrium", false, Layer::radiance},
                          Case{"cornell", false, Layer::final}}) {
        SCOPED_TRACE(fmt::format("{}, indirect light {}", c.scene, c.gi));
        scene::Scene scene = must(scene::make_builtin(c.scene));
        if (c.scene == "atrium") scene.environment_radiance = glm::vec3(0);
        const frame::Rendered rendered =
            render(device(), scene,
                   {.size = {16, 16}, .gi = c.gi, .layers = {c.layer}, .voxels = {.resolution = 16}});
        const std::set<std::string> passes = pass_names(rendered);
        for (const Absent& absent : absences) {
            const bool needed = rendered.plan.needs(absent.item);
            if (!needed) tried.insert(absent.item);
            for (const std::string& pass : absent.passes) EXPECT_EQ(passes.contains(pass), needed) << pass;
            for (const std::string& resource : absent.resources)
                EXPECT_EQ(holds(rendered, resource), needed) << resource;
        }
    }
    EXPECT_EQ(tried.size(), std::size(absences)) << "each has been left out at least once";
}

}  // namespace
}  // namespace lumo
