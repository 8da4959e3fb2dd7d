// Pictures that were traced once: found for the same content alone, and never believed when they are damaged.
#include <filesystem>
#include <fstream>
#include <functional>
#include <gtest/gtest.h>
#include <unistd.h>

#include "reference/cache.hpp"
#include "scene/builtin/builtin.hpp"
#include "scene/content_key.hpp"

namespace lumo::reference {
namespace {

class ReferenceCache : public testing::Test {
  protected:
    ~ReferenceCache() override { std::filesystem::remove_all(cache_.folder()); }

    CachedTrace trace() const {
        auto result = path_trace_cached(scene_, camera_, settings_, cache_);
        EXPECT_TRUE(result) << to_string(result.error());
        return result ? std::move(*result) : CachedTrace{};
    }

    scene::Scene scene_ = scene::make_builtin("cornell").value();
    scene::Camera camera_ = default_camera(scene_);
    PathTracerSettings settings_{
        .width = 8, .height = 6, .spp = 2, .layers = {TracedLayer::irradiance, TracedLayer::depth}};
    rhi::DiskCache cache_{std::filesystem::path(testing::TempDir()) /
                          ("lumo-reference-" + std::to_string(getpid()))};
};

TEST_F(ReferenceCache, TheSecondTimeNothingIsTracedAndAllIsTheSame) {
    const CachedTrace first = trace(), second = trace();
    EXPECT_FALSE(first.found);
    EXPECT_TRUE(first.stored);
    ASSERT_TRUE(second.found);
    ASSERT_EQ(second.traced.layers.size(), 2);
    for (size_t i = 0; i < 2; ++i) {
        const TracedImage &a = first.traced.layers[i], &b = second.traced.layers[i];
        EXPECT_EQ(a.layer, b.layer);
        EXPECT_EQ(a.mean.values, b.mean.values);
        EXPECT_EQ(a.mean.width, b.mean.width);
        EXPECT_EQ(a.mean.height, b.mean.height);
        EXPECT_EQ(a.mean.channels, b.mean.channels);
        EXPECT_EQ(a.noise.values, b.noise.values);
        EXPECT_EQ(a.relative_noise, b.relative_noise);
    }
}

TEST_F(ReferenceCache, WhatChangesThePictureIsTraced) {
    trace();
    const auto fresh = [&](const char* what) { EXPECT_FALSE(trace().found) << what; };
    settings_.spp = 3, fresh("spp");
    settings_.bounces = 2, fresh("bounces");
    settings_.bounces.reset(), fresh("all bounces");
    settings_.width = 9, fresh("width");
    settings_.diffuse_materials = true, fresh("materials");
    settings_.layers.pop_back(), fresh("layers");
    camera_.position.x += 0.01f, fresh("camera");
    scene_.lights.push_back({.intensity = {1, 1, 1}}), fresh("a light");
    scene_.environment_radiance = {0, 0, 1}, fresh("the environment");
    scene_.materials.front().base_color.g *= 0.5f, fresh("a material");
    scene_.vertices.front().position.y += 0.01f, fresh("a vertex");
}

TEST_F(ReferenceCache, WhatDoesNotIsNot) {
    trace();
    settings_.threads = 1;
    scene_.name = "another";
    scene_.warnings.emplace_back("a warning");
    EXPECT_TRUE(trace().found);
}

TEST_F(ReferenceCache, DamagedEntriesAreTracedAgainAndReplaced) {
    const CachedTrace first = trace();
    for (const auto& entry : std::filesystem::directory_iterator(cache_.folder())) {
        std::fstream file(entry.path(), std::ios::in | std::ios::out | std::ios::binary);
        file.seekp(-5, std::ios::end);
        file.put('x');
    }
    const CachedTrace again = trace();
    EXPECT_FALSE(again.found);
    EXPECT_EQ(again.traced[TracedLayer::irradiance].mean.values,
              first.traced[TracedLayer::irradiance].mean.values);
    EXPECT_TRUE(trace().found);
}

TEST_F(ReferenceCache, WithoutAFolderItTracesAndSaysWhyNothingIsKept) {
    cache_ = rhi::DiskCache({});
    const CachedTrace traced = trace();
    EXPECT_FALSE(traced.found);
    EXPECT_FALSE(traced.stored);
    EXPECT_EQ(traced.traced.layers.size(), 2);
}

TEST(SceneContent, EveryPartOfASceneHasAKeyOfItsOwn) {
    scene::Scene scene = scene::make_builtin("cornell").value();
    EXPECT_EQ(content_key(scene::make_builtin("cornell").value()), content_key(scene));
    EXPECT_NE(content_key(scene::make_builtin("furnace").value()), content_key(scene));
    scene.images.push_back({.width = 1, .height = 1, .values = {1, 2, 3, 4}});
    scene.textures.emplace_back();
    scene.lights.push_back({.direction = {1, 0, 0}});
    const rhi::CacheKey key = content_key(scene);
    const std::vector<std::function<void(scene::Scene&)>> changes{
        [](scene::Scene& s) { std::swap(s.indices[0], s.indices[1]); },
        [](scene::Scene& s) { s.instances.front().world_from_object[3].x += 1; },
        [](scene::Scene& s) { s.materials.front().roughness *= 0.5f; },
        [](scene::Scene& s) { s.materials.front().alpha_mode = scene::AlphaMode::blend; },
        [](scene::Scene& s) { s.materials.front().normal_texture = scene::TextureSlot{}; },
        [](scene::Scene& s) { s.images.front().values.front() ^= 1; },
        [](scene::Scene& s) { s.textures.front().sampler.wrap_u = scene::Wrap::clamp_to_edge; },
        [](scene::Scene& s) {
            s.lights.front().direction = {0, -1, 0};
        },
        [](scene::Scene& s) { s.meshes.front().primitives.pop_back(); },
    };
    for (size_t i = 0; i < changes.size(); ++i) {
        scene::Scene changed = scene;
        changes[i](changed);
        EXPECT_NE(content_key(changed), key) << "change " << i;
    }
}

}  // namespace
}  // namespace lumo::reference
