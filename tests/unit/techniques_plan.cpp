// What a plan makes of the facts of a scene: it looks at nothing else.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <set>

#include "scene/builtin/builtin.hpp"
#include "techniques/frame/plan.hpp"

namespace lumo::frame {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::IsSupersetOf;
using testing::Not;
using testing::UnorderedElementsAre;

std::set<std::string> needed(const Plan& plan) {
    std::set<std::string> names;
    for (const PlanItem& item : plan.items)
        if (item.needed) names.insert(item.what);
    return names;
}

const PlanItem& item(const Plan& plan, std::string_view what) {
    for (const PlanItem& i : plan.items)
        if (i.what == what) return i;
    throw std::runtime_error("the plan does not mention " + std::string(what));
}

SceneFacts surfaces() { return {.triangles = 12, .specular = true}; }

TEST(Plan, EmptySceneNeedsAPictureAlone) {
    const SceneFacts facts{.lights = true};
    EXPECT_THAT(needed(make_plan(facts, {})), UnorderedElementsAre("gbuffer", "lighting", "post"));
    EXPECT_THAT(item(make_plan(facts, {}), "voxels").why, HasSubstr("no triangles"));
}

TEST(Plan, WithoutLightThereIsNothingToGather) {
    const Plan plan = make_plan(surfaces(), {});
    EXPECT_THAT(needed(plan), UnorderedElementsAre("gbuffer", "lighting", "lighting.specular", "post"));
    EXPECT_THAT(item(plan, "voxels").why, HasSubstr("no light"));
}

TEST(Plan, SunAlone) {
    SceneFacts facts = surfaces();
    facts.lights = true;
    EXPECT_THAT(needed(make_plan(facts, {})),
                UnorderedElementsAre("gbuffer", "shadow", "voxels", "voxels.light", "cones", "cones.specular",
                                     "lighting", "lighting.specular", "post"));
    // Injection is the first reflection; a second has to be gathered.
    EXPECT_TRUE(make_plan(facts, {.bounces = 2}).needs("voxels.bounce"));
}

/// Rays stand in for the cones of opaque surfaces, and the plan says so; not a full one holds both.
TEST(Plan, RaysInPlaceOfCones) {
    SceneFacts facts = surfaces();
    facts.lights = facts.emission = true;
    for (const Gatherer gatherer : {Gatherer::rays, Gatherer::floor})
        for (const PlanMode mode : {PlanMode::automatic, PlanMode::full}) {
            const Plan plan = make_plan(facts, resolve({.plan = mode, .gatherer = gatherer}, facts));
            EXPECT_TRUE(plan.needs("cones.rays"));
            EXPECT_FALSE(plan.needs("cones"));
            EXPECT_TRUE(plan.needs("cones.specular"));
            EXPECT_TRUE(plan.needs("cones.emitters"));
            EXPECT_THAT(item(plan, "cones").why, HasSubstr("rays"));
            EXPECT_THAT(item(plan, "cones.rays").why,
                        HasSubstr(gatherer == Gatherer::floor ? "256 rays" : "16 rays"));
        }
    EXPECT_EQ(resolve({.gatherer = Gatherer::floor, .rays = 7}, facts).rays, 7u);
    EXPECT_FALSE(make_plan(facts, {.gi = false, .gatherer = Gatherer::rays}).needs("cones.rays"));
}

TEST(Plan, EmittersAlone) {
    SceneFacts facts = surfaces();
    facts.emission = true;
    const Plan plan = make_plan(facts, {});
    EXPECT_THAT(needed(plan),
                UnorderedElementsAre("gbuffer", "gbuffer.emission", "voxels", "voxels.emission",
                                     "voxels.bounce", "cones", "cones.specular", "cones.emitters", "lighting",
                                     "lighting.specular", "post"));
    EXPECT_THAT(item(plan, "shadow").why, HasSubstr("no analytic light"));
}

TEST(Plan, EnvironmentAlone) {
    SceneFacts facts = surfaces();
    facts.environment = true;
    EXPECT_THAT(needed(make_plan(facts, {})),
                UnorderedElementsAre("gbuffer", "voxels", "voxels.bounce", "cones", "cones.specular",
                                     "cones.environment", "lighting", "lighting.specular", "post"));
}

TEST(Plan, SkyIsMadeWhereItLightsOrIsSeen) {
    SceneFacts facts = surfaces();
    facts.sky = facts.environment = facts.lights = true;
    EXPECT_THAT(needed(make_plan(facts, {})), IsSupersetOf({"sky.map", "sky.pixels", "cones.environment"}));
    const Plan unlit = make_plan(facts, {.gi = false});
    EXPECT_FALSE(unlit.needs("sky.map"));
    EXPECT_TRUE(unlit.needs("sky.pixels"));
    const Plan unseen = make_plan(facts, {.layers = {Layer::irradiance, Layer::depth}});
    EXPECT_TRUE(unseen.needs("sky.map"));
    EXPECT_FALSE(unseen.needs("sky.pixels"));
    EXPECT_THAT(item(unseen, "sky.pixels").why, HasSubstr("no layer"));
    EXPECT_FALSE(make_plan(facts, {}).needs("blend.air"));
    facts.alpha_blend = true;
    EXPECT_TRUE(make_plan(facts, {}).needs("blend.air"));
    EXPECT_THAT(item(make_plan(facts, {.layers = {Layer::irradiance}}), "blend.air").why,
                HasSubstr("no layer"));
    facts.triangles = 0;
    EXPECT_FALSE(make_plan(facts, {}).needs("sky.map"));
    EXPECT_TRUE(make_plan(facts, {}).needs("sky.pixels"));
    facts.sky = false;
    EXPECT_THAT(item(make_plan(facts, {}), "sky.pixels").why, HasSubstr("no sky"));
    EXPECT_THAT(item(make_plan(facts, {}), "blend.air").why, HasSubstr("no sky"));
}

TEST(Resolve, ExposureIsTheSkysUnlessAsked) {
    EXPECT_EQ(resolve({}, {}).post.exposure, 0);
    EXPECT_EQ(resolve({}, {.sky = true}).post.exposure, daylight_exposure);
    EXPECT_EQ(resolve({}, {.sky = true, .dusk = 3}).post.exposure, daylight_exposure + 3);
    EXPECT_EQ(resolve({.exposure = 1.5f}, {.sky = true}).post.exposure, 1.5f);
    EXPECT_EQ(resolve({.post = {.exposure = -2}}, {}).post.exposure, -2);
}

TEST(Plan, MaskBlendUnlitAndNormalMaps) {
    SceneFacts facts = surfaces();
    facts.lights = facts.alpha_mask = facts.alpha_blend = facts.unlit = facts.normal_maps = true;
    const std::set<std::string> with = needed(make_plan(facts, {}));
    EXPECT_THAT(with, IsSupersetOf({"gbuffer.mask", "voxels.mask", "voxels.opacity", "blend",
                                    "gbuffer.emission", "gbuffer.normal_maps"}));
    EXPECT_FALSE(with.contains("voxels.emission")) << "unlit surfaces shine on nothing";
}

TEST(Plan, WithoutIndirectLightNoVoxels) {
    SceneFacts facts = surfaces();
    facts.lights = facts.emission = facts.environment = facts.alpha_mask = facts.alpha_blend = true;
    const Plan plan = make_plan(facts, {.gi = false});
    for (const std::string& name : needed(plan)) {
        EXPECT_THAT(name, Not(HasSubstr("voxels")));
        EXPECT_THAT(name, Not(HasSubstr("cones")));
    }
    EXPECT_TRUE(plan.needs("shadow"));
    EXPECT_THAT(item(plan, "voxels").why, HasSubstr("off"));
}

/// Opacity needs no light, nor indirect light to be wanted.
TEST(Plan, AmbientOcclusionOnlyWhereItIsAskedFor) {
    const Settings asked{.gi = false, .layers = {Layer::ao}};
    SceneFacts facts = surfaces();
    facts.alpha_mask = true;
    EXPECT_THAT(needed(make_plan(facts, asked)),
                UnorderedElementsAre("gbuffer", "gbuffer.mask", "voxels", "voxels.mask", "cones.ao",
                                     "lighting", "lighting.specular"));
    EXPECT_THAT(item(make_plan(facts, asked), "cones.ao").why, HasSubstr("asked for"));
    EXPECT_THAT(item(make_plan(facts, {}), "cones.ao").why, HasSubstr("not asked for"));
    EXPECT_FALSE(make_plan({}, asked).needs("cones.ao"));
}

TEST(Layers, NamesAreRead) {
    std::set<std::string_view> names;
    for (int i = 0; i < layer_count; ++i) {
        const auto name = to_string(Layer(i));
        EXPECT_EQ(layer_from_string(name), Layer(i)) << name;
        names.insert(name);
    }
    EXPECT_EQ(names.size(), size_t(layer_count));
    EXPECT_EQ(layer_from_string("ao"), Layer::ao);
    EXPECT_FALSE(layer_from_string("glow"));
}

TEST(Plan, DisplayOnlyWhereItIsShown) {
    EXPECT_TRUE(make_plan(surfaces(), {.layers = {Layer::radiance, Layer::final}}).needs("post"));
    EXPECT_FALSE(make_plan(surfaces(), {.layers = {Layer::radiance, Layer::depth}}).needs("post"));
}

TEST(Plan, WhatTheSettingsRuleOutIsNotForced) {
    const Settings settings{.diffuse_materials = true, .plan = PlanMode::full};
    const Plan plan = make_plan({.triangles = 5, .lights = true}, settings);
    for (const char* what : {"cones.specular", "lighting.specular"}) {
        EXPECT_FALSE(plan.needs(what)) << what;
        EXPECT_THAT(item(plan, what).why, HasSubstr("taken as diffuse"));
    }
}

/// Every combination of facts: full needs all, mentions the same, never changes what automatic says of the rest.
TEST(Plan, FullForcesEverythingAndSaysSo) {
    for (unsigned bits = 0; bits < 1u << 10; ++bits) {
        const auto bit = [bits](unsigned i) { return (bits >> i & 1) != 0; };
        const SceneFacts facts{.triangles = bit(0) ? 5u : 0u,
                               .alpha_mask = bit(1),
                               .alpha_blend = bit(2),
                               .emission = bit(3),
                               .unlit = bit(4),
                               .normal_maps = bit(5),
                               .specular = bit(6),
                               .environment = bit(7),
                               .sky = bit(9),
                               .lights = bit(8)};
        for (const bool gi : {true, false}) {
            Settings settings{.gi = gi};
            const Plan automatic = make_plan(facts, settings);
            settings.plan = PlanMode::full;
            const Plan full = make_plan(facts, settings);
            ASSERT_EQ(full.items.size(), automatic.items.size());
            for (size_t i = 0; i < full.items.size(); ++i) {
                ASSERT_EQ(full.items[i].what, automatic.items[i].what);
                ASSERT_THAT(automatic.items[i].why, Not(IsEmpty()));
                ASSERT_TRUE(full.items[i].needed);
                const std::string prefix = automatic.items[i].needed ? "" : "forced: ";
                ASSERT_EQ(full.items[i].why, prefix + automatic.items[i].why);
            }
            // Nothing that works on voxels without the voxels.
            for (const char* part :
                 {"voxels.mask", "voxels.opacity", "voxels.emission", "voxels.light", "voxels.bounce",
                  "cones", "cones.specular", "cones.environment", "sky.map"}) {
                ASSERT_TRUE(!automatic.needs(part) || automatic.needs("voxels")) << part;
            }
            ASSERT_TRUE(!automatic.needs("voxels.light") || automatic.needs("shadow"));
        }
    }
}

TEST(Plan, TextHasALinePerItem) {
    const Plan plan = make_plan(surfaces(), {});
    const std::string text = to_text(plan);
    EXPECT_EQ(size_t(std::count(text.begin(), text.end(), '\n')), plan.items.size());
    for (const PlanItem& i : plan.items) {
        EXPECT_THAT(text, HasSubstr(i.what));
        EXPECT_THAT(text, HasSubstr(i.why));
    }
    EXPECT_FALSE(plan.needs("nothing of this name"));
}

scene::Scene with_material(scene::Material material) {
    scene::Scene scene;
    scene.vertices = {{.position = {0, 0, 0}}, {.position = {1, 0, 0}}, {.position = {0, 1, 0}}};
    scene.indices = {0, 1, 2};
    scene.materials = {std::move(material)};
    scene.meshes = {{.primitives = {{0, 3, 0}}}};
    scene.instances = {{.mesh = 0}};
    return scene;
}

TEST(Examine, FindsWhatMaterialsAre) {
    EXPECT_FALSE(examine(with_material({}), {}).alpha_mask);
    EXPECT_TRUE(examine(with_material({.alpha_mode = scene::AlphaMode::mask}), {}).alpha_mask);
    EXPECT_TRUE(examine(with_material({.alpha_mode = scene::AlphaMode::blend}), {}).alpha_blend);
    EXPECT_TRUE(examine(with_material({.unlit = true}), {}).unlit);
    EXPECT_FALSE(examine(with_material({.unlit = true}), {}).specular);
    const SceneFacts emitter = examine(with_material({.emission = {0.5f, 20, 3}}), {});
    EXPECT_TRUE(emitter.emission);
    EXPECT_TRUE(emitter.wide_range());
    EXPECT_EQ(emitter.highest_emission, 20);
}

TEST(Examine, CountsOnlyWhatInstancesUse) {
    scene::Scene scene = with_material({});
    scene.materials.push_back({.emission = {1, 1, 1}, .alpha_mode = scene::AlphaMode::mask});
    scene.meshes.push_back({.primitives = {{0, 3, 1}}});
    const SceneFacts unused = examine(scene, {});
    EXPECT_FALSE(unused.emission);
    EXPECT_FALSE(unused.alpha_mask);
    EXPECT_EQ(unused.triangles, 1u);
    scene.instances.push_back({.mesh = 1});
    scene.instances.push_back({.mesh = 1});
    const SceneFacts used = examine(scene, {});
    EXPECT_TRUE(used.emission);
    EXPECT_TRUE(used.alpha_mask);
    EXPECT_EQ(used.triangles, 3u);
}

TEST(Examine, LightsThatGiveNoneAreNone) {
    scene::Scene scene = with_material({});
    scene.lights = {{.kind = scene::LightKind::directional, .intensity = {0, 0, 0}},
                    {.kind = scene::LightKind::point, .intensity = {0, 0, 0}}};
    EXPECT_FALSE(examine(scene, {}).lights);
    scene.lights.push_back({.kind = scene::LightKind::directional, .intensity = {0, 1e-6f, 0}});
    EXPECT_TRUE(examine(scene, {}).lights);
    EXPECT_EQ(examine(scene, {}).light_cameras, 1u);
    scene.lights.push_back({.kind = scene::LightKind::point, .intensity = {1, 0, 0}});
    EXPECT_EQ(examine(scene, {}).light_cameras, 7u);
    EXPECT_FALSE(examine(scene, {}).environment);
    scene.environment_radiance = {0, 0, 1e-6f};
    EXPECT_TRUE(examine(scene, {}).environment);
}

TEST(Examine, DiffuseMaterialsHaveNeitherHighlightsNorNormalMaps) {
    scene::Scene scene = with_material({});
    scene.images.push_back({1, 1, 4, {128, 128, 255, 255}});
    scene.textures.push_back({});
    scene.materials[0].normal_texture = scene::TextureSlot{};
    EXPECT_TRUE(examine(scene, {}).normal_maps);
    EXPECT_TRUE(examine(scene, {}).specular);
    const SceneFacts diffuse = examine(scene, {.diffuse_materials = true});
    EXPECT_FALSE(diffuse.normal_maps);
    EXPECT_FALSE(diffuse.specular);
}

}  // namespace
}  // namespace lumo::frame
