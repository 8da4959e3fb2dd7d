// Shadows, direct light and composition against closed forms.
#include "techniques/lighting/lighting.hpp"

#include <gtest/gtest.h>

#include "tests/support/device_test.hpp"
#include "tests/support/rendering.hpp"

namespace lumo::lighting {
namespace {

using namespace testing_support;

constexpr rhi::Extent size{96, 64};

struct LightingTest : DeviceTest {};
INSTANTIATE_TEST_SUITE_P(Accuracy, LightingTest, both_apis, api_name);

/// Looks down on the floor, with -z up in the picture.
scene::Camera from_above(float height) {
    scene::Camera camera;
    camera.position = {0, height, 0};
    camera.target = {0, 0, 0};
    camera.up = {0, 0, -1};
    camera.near_plane = 0.5f;
    camera.far_plane = 100;
    return camera;
}

void add_floor(scene::Scene& scene, float half_side, scene::Material material = {}) {
    add_quad(scene, {0, 0, 0}, {half_side, 0, 0}, {0, 0, -half_side}, std::move(material));
}

glm::vec3 sun_at(double elevation, double azimuth) {
    return glm::vec3(std::cos(elevation) * std::cos(azimuth), std::sin(elevation),
                     std::cos(elevation) * std::sin(azimuth));
}

/// An unshadowed white Lambertian floor is lit by exactly E cos / pi: no acne at any height of the sun.
TEST_P(LightingTest, PlanesDoNotShadowThemselves) {
    scene::Scene scene;
    add_floor(scene, 10);
    const scene::Camera camera = from_above(8);
    for (const double elevation : {89.0, 60.0, 30.0, 10.0, 3.0, 1.0})
        for (const double azimuth : {0.0, 37.0, 200.0}) {
            const Sun sun{sun_at(glm::radians(elevation), glm::radians(azimuth)), {3, 2, 1}};
            const RenderedTargets targets =
                render(device(), scene, camera, {.size = size, .sun = sun, .diffuse_materials = true});
            for (uint32_t y = 0; y < size.height; ++y)
                for (uint32_t x = 0; x < size.width; ++x)
                    for (int c = 0; c < 3; ++c) {
                        const double expected =
                            double(sun.irradiance[c]) / M_PI * std::sin(glm::radians(elevation));
                        ASSERT_NEAR(targets.direct.at(x, y)[c], expected, 2e-6 * expected)
                            << x << ", " << y << ", elevation " << elevation << ", azimuth " << azimuth;
                    }
        }
}

/// A curved surface, in facets, has no acne either.
TEST_P(LightingTest, FacetsDoNotShadowThemselves) {
    scene::Scene scene;
    constexpr int strips = 48;  // of a half cylinder of radius 2 along z
    for (int i = 0; i < strips; ++i) {
        const double a0 = M_PI * i / strips, a1 = M_PI * (i + 1) / strips, middle = 0.5 * (a0 + a1);
        const glm::dvec3 p0(std::cos(a0), std::sin(a0), 0), p1(std::cos(a1), std::sin(a1), 0);
        add_quad(scene, glm::vec3(p0 + p1), {0, 0, -2}, glm::vec3(p1 - p0), {});
        for (size_t k = scene.vertices.size() - 4; k < scene.vertices.size(); ++k) {
            const glm::vec3 p = scene.vertices[k].position;
            scene.vertices[k].normal = glm::normalize(glm::vec3(p.x, p.y, 0));
        }
        ASSERT_GT(glm::dot(glm::cross(glm::dvec3(0, 0, -2), p1 - p0),
                           glm::dvec3(std::cos(middle), std::sin(middle), 0)),
                  0);
    }
    const Sun sun{glm::normalize(glm::vec3(1, 0.7f, 0.2f)), glm::vec3(1)};
    const RenderedTargets targets =
        render(device(), scene, from_above(7), {.size = size, .sun = sun, .diffuse_materials = true});
    int lit = 0;
    for (uint32_t y = 0; y < size.height; ++y)
        for (uint32_t x = 0; x < size.width; ++x) {
            if (targets.depth.at(x, y).x == 1) continue;
            const float cosine = glm::dot(glm::normalize(glm::vec3(targets.normal_roughness.at(x, y))),
                                          glm::normalize(sun.direction));
            // A facet turns 3.75 degrees: nearer to the terminator the flat facet may look away from the sun.
            if (cosine < std::sin(glm::radians(4.0))) continue;
            ++lit;
            ASSERT_NEAR(targets.direct.at(x, y).x, cosine / M_PI, 2e-3) << x << ", " << y;
        }
    EXPECT_GT(lit, 500);
}

/// The shadow of a square on a floor is the square moved by the sun: dark inside, lit outside, half at its edge.
TEST_P(LightingTest, ShadowOfAnOccluderLiesWhereItShould) {
    constexpr float height = 1.5f;
    scene::Scene scene;
    add_floor(scene, 6);
    add_quad(scene, {1, height, 0.5f}, {0.9f, 0, 0}, {0, 0, -0.7f}, {});
    const Sun sun{sun_at(glm::radians(50.0), glm::radians(160.0)), glm::vec3(2)};
    const scene::Camera camera = from_above(9);
    const RenderedTargets targets =
        render(device(), scene, camera, {.size = size, .sun = sun, .diffuse_materials = true});
    const double texel = double(glm::length(targets.light.texel_size)) / std::sin(glm::radians(50.0));
    const glm::dvec3 shift = glm::dvec3(sun.direction) * double(height) / double(sun.direction.y);
    const double lit =
        double(targets.base_color_metallic.at(2, 2).x) / M_PI * 2 * std::sin(glm::radians(50.0));
    int in_shadow = 0, in_light = 0;
    for (uint32_t y = 0; y < size.height; ++y)
        for (uint32_t x = 0; x < size.width; ++x) {
            const Ray ray = pixel_ray(camera, size, x, y);
            const auto inside_occluder = [](glm::dvec3 p) {
                return std::max(std::abs(p.x - 1) - 0.9, std::abs(p.z - 0.5) - 0.7);  // metres, signed
            };
            const glm::dvec3 above =
                ray.origin + ray.direction * ((double(height) - ray.origin.y) / ray.direction.y);
            if (inside_occluder(above) < 0.01) continue;  // the occluder itself
            const glm::dvec3 floor = ray.origin - ray.direction * (ray.origin.y / ray.direction.y);
            const double distance = inside_occluder(floor + shift);
            const double direct = double(targets.direct.at(x, y).x);
            if (distance < -2 * texel) {
                ++in_shadow;
                ASSERT_EQ(direct, 0) << x << ", " << y;
            } else if (distance > 2 * texel) {
                ++in_light;
                ASSERT_NEAR(direct, lit, 1e-5 * lit) << x << ", " << y;
            } else {
                ASSERT_GE(direct, 0);
                ASSERT_LE(direct, lit * (1 + 1e-5));
            }
        }
    EXPECT_GT(in_shadow, 50);
    EXPECT_GT(in_light, 1000);
}

/// What stands out of a plane by two texels of the map shadows it under a sun that grazes it, to a texel.
TEST_P(LightingTest, LowRidgesCastLongShadows) {
    constexpr double elevation = 10 * M_PI / 180, height = 0.0113;  // metres
    scene::Scene scene;
    scene::Material two_sided;
    two_sided.double_sided = true;
    add_floor(scene, 4);
    add_quad(scene, {0, height / 2, 0}, {0, 0, -4}, {0, height / 2, 0}, two_sided);
    scene::Camera camera = from_above(2);
    camera.orthographic_height = 1;
    const RenderedTargets targets = render(device(), scene, camera,
                                           {.size = size,
                                            .sun = Sun{sun_at(elevation, 0), glm::vec3(1)},
                                            .diffuse_materials = true,
                                            .shadow = {.resolution = 256}});
    const double texel = double(targets.light.texel_size.y);  // across the rays, in their vertical plane
    EXPECT_NEAR(height * std::cos(elevation), 2 * texel, 0.1 * texel);
    const double full = std::sin(elevation) / M_PI;
    double shadow = 0;  // its length, metres
    for (uint32_t y = 0; y < size.height; ++y)
        for (uint32_t x = 0; x < size.width; ++x)
            shadow += (1 - double(targets.direct.at(x, y).x) / full) / (size.height * size.height);
    EXPECT_NEAR(shadow, height / std::tan(elevation), texel / std::sin(elevation));
}

/// However a normal map bends its normals, a surface is dark where it faces away.
TEST_P(LightingTest, BentNormalsSeeNoLightBehindTheSurface) {
    scene::Scene scene;
    scene::Material bumpy;
    bumpy.normal_texture = add_texel(scene, {255, 128, 128, 255});
    add_floor(scene, 2, bumpy);
    for (const float height : {0.2f, -0.2f}) {
        const RenderedTargets targets =
            render(device(), scene, from_above(3),
                   {.size = size, .sun = Sun{glm::normalize(glm::vec3(1, height, 0)), glm::vec3(1)}});
        EXPECT_EQ(targets.direct.at(48, 32).x > 0.1f, height > 0) << height;
    }
}

/// Cut-out parts of a masked surface let the sun through, and blended surfaces cast nothing.
TEST_P(LightingTest, MaskedSurfacesCastTheirShapeAndBlendedOnesNothing) {
    for (const bool position_target : {false, true})
        for (const scene::AlphaMode mode : {scene::AlphaMode::mask, scene::AlphaMode::blend}) {
            scene::Scene scene;
            add_floor(scene, 4);
            scene::Material material{.alpha_mode = mode};
            material.base_color_texture = add_texel(scene, {});
            scene.images[0] = {2, 1, 4, {255, 255, 255, 0, 255, 255, 255, 255}};
            scene.textures[0].sampler = {.magnification = scene::Filter::nearest,
                                         .minification = scene::Filter::nearest,
                                         .mip = {},
                                         .wrap_u = scene::Wrap::clamp_to_edge};
            // Between the sun and the floor, away from what the camera sees.
            add_quad(scene, {0, 2, 0}, {1, 0, 0}, {0, 0, -1}, material);
            const Sun sun{{0, 1, 0}, glm::vec3(1)};
            scene::Camera camera = from_above(1.5f);
            camera.orthographic_height = 1.5f;
            const RenderedTargets targets = render(device(), scene, camera,
                                                   {.size = size,
                                                    .sun = sun,
                                                    .diffuse_materials = true,
                                                    .shadow = {.position_target = position_target}});
            const bool cut = mode == scene::AlphaMode::mask;
            EXPECT_EQ(targets.direct.at(60, 32).x > 0, !cut) << "the opaque half";
            EXPECT_GT(targets.direct.at(36, 32).x, 0) << "the cut half";
        }
}

/// The target of positions holds what the depth beside it says.
TEST_P(LightingTest, PositionTargetAgreesWithDepth) {
    scene::Scene scene;
    add_floor(scene, 3);
    add_quad(scene, {0.5f, 1, 0}, {1, 0.3f, 0}, {0, 0.2f, -0.6f}, {});
    const RenderedTargets targets = render(device(), scene, from_above(5),
                                           {.size = size,
                                            .sun = Sun{{0.4f, 1, 0.7f}, glm::vec3(1)},
                                            .shadow = {.resolution = 128, .position_target = true}});
    ASSERT_EQ(targets.shadow_position.texels.size(), size_t(128 * 128));
    int covered = 0;
    for (uint32_t y = 0; y < 128; ++y)
        for (uint32_t x = 0; x < 128; ++x) {
            const float depth = targets.shadow.at(x, y).x;
            const glm::vec4 position = targets.shadow_position.at(x, y);
            ASSERT_EQ(position.w, depth < 1 ? 1 : 0);
            if (depth == 1) continue;
            ++covered;
            const glm::vec4 clip((float(x) + 0.5f) / 64 - 1, (float(y) + 0.5f) / 64 - 1, depth, 1);
            ASSERT_LT(glm::distance(position, targets.light.world_from_clip * clip), 1e-5f);
        }
    EXPECT_GT(covered, 1000);
}

/// The edge itself: over one edge of a shadow, seen close, the light grows steadily from nothing to all.
TEST_P(LightingTest, ShadowEdgesAreSmoothAndCentred) {
    scene::Scene scene;
    add_floor(scene, 2);
    add_quad(scene, {-1, 1, 0}, {1, 0, 0}, {0, 0, -2}, {});
    scene::Camera camera = from_above(0.5f);
    camera.near_plane = 0.1f;
    camera.orthographic_height = 0.2f;
    const Sun sun{{0, 1, 0}, glm::vec3(static_cast<float>(M_PI))};
    const RenderedTargets targets =
        render(device(), scene, camera,
               {.size = size, .sun = sun, .diffuse_materials = true, .shadow = {.resolution = 256}});
    const double texel = double(targets.light.texel_size.x);
    const uint32_t row = size.height / 2;
    double lit_length = 0;
    const double pixel = 0.2 / size.height;
    const double full = double(targets.direct.at(size.width - 1, row).x);
    for (uint32_t x = 1; x < size.width; ++x) {
        const double step = double(targets.direct.at(x, row).x - targets.direct.at(x - 1, row).x);
        ASSERT_GE(step, -1e-6) << x;
        // A box of two texels spreads the edge evenly over them.
        ASSERT_LE(step, 1.05 * full * pixel / (2 * texel) + 1e-6) << x;
    }
    for (uint32_t x = 0; x < size.width; ++x)
        lit_length += double(targets.direct.at(x, row).x) / full * pixel;
    EXPECT_EQ(targets.direct.at(0, row).x, 0);
    // The edge is at the middle of the picture, known to half a texel.
    EXPECT_NEAR(lit_length, 0.5 * size.width * pixel, 0.51 * texel);
}

TEST_P(LightingTest, WhatFacesAwayIsDark) {
    scene::Scene scene;
    scene::Material material;
    material.double_sided = true;
    add_floor(scene, 2, material);
    scene::Camera camera = from_above(3);
    camera.position = {0, -3, 0};
    const RenderedTargets targets =
        render(device(), scene, camera,
               {.size = size, .sun = Sun{{0.2f, 1, 0.1f}, glm::vec3(5)}, .diffuse_materials = true});
    EXPECT_LT(targets.depth.at(48, 32).x, 1);
    EXPECT_EQ(targets.direct.at(48, 32), glm::vec4(0, 0, 0, 1));
}

TEST_P(LightingTest, RadianceIsTheSumOfItsParts) {
    scene::Scene scene;
    scene::Material material{.base_color = {0.5f, 0.5f, 0.5f, 1}, .metallic = 0.3f, .roughness = 0.4f};
    material.emission = {0.5f, 0.25f, 4};
    add_floor(scene, 2, material);
    const glm::vec3 environment{0.1f, 0.2f, 0.3f};
    const RenderedTargets targets =
        render(device(), scene, from_above(6),
               {.size = size, .sun = Sun{{0.5f, 1, 0.25f}, glm::vec3(5)}, .environment = environment});
    int background = 0;
    for (size_t i = 0; i < targets.radiance.texels.size(); ++i) {
        const glm::vec4 sum = targets.direct.texels[i] + targets.indirect.texels[i];
        if (targets.depth.texels[i].x == 1) {
            ++background;
            ASSERT_EQ(glm::vec3(targets.radiance.texels[i]), environment);
            ASSERT_EQ(glm::vec3(sum), glm::vec3(0));
            continue;
        }
        ASSERT_GT(targets.direct.texels[i].x, 0);
        for (int c = 0; c < 3; ++c) {
            const float whole = sum[c] + targets.emission.texels[i][c];
            ASSERT_NEAR(targets.radiance.texels[i][c], whole, 1e-6f * whole);
        }
    }
    EXPECT_GT(background, 100);
}

TEST_P(LightingTest, UnlitSurfacesShowTheirColour) {
    scene::Scene scene;
    scene::Material material{.base_color = {0.5f, 0.25f, 0.125f, 1}};
    material.unlit = true;
    add_floor(scene, 2, material);
    const RenderedTargets targets =
        render(device(), scene, from_above(3), {.size = size, .sun = Sun{{0, 1, 0}, glm::vec3(9)}});
    EXPECT_EQ(targets.radiance.at(48, 32), glm::vec4(0.5f, 0.25f, 0.125f, 1));
}

/// Blended surfaces go over what is behind them from back to front, in whatever order the scene has them.
TEST_P(LightingTest, BlendedSurfacesComposeFromBackToFront) {
    const glm::vec4 far_color{0.9f, 0.1f, 0.2f, 0.5f}, near_color{0.1f, 0.8f, 0.3f, 0.25f};
    for (const bool near_first : {false, true}) {
        scene::Scene scene;
        scene::Material floor{.base_color = {0.5f, 0.5f, 0.5f, 1}};
        floor.unlit = true;
        add_floor(scene, 2, floor);
        const auto add = [&](glm::vec4 color, float height) {
            scene::Material material{.base_color = color, .alpha_mode = scene::AlphaMode::blend};
            material.unlit = true;
            add_quad(scene, {0, height, 0}, {1, 0, 0}, {0, 0, -1}, material);
        };
        if (near_first) add(near_color, 1);
        add(far_color, 0.5f);
        if (!near_first) add(near_color, 1);
        // One below the floor, which hides it.
        add({1, 1, 1, 1}, -0.5f);
        const RenderedTargets targets = render(device(), scene, from_above(4), {.size = size});
        glm::dvec3 expected(0.5);
        expected = glm::mix(expected, glm::dvec3(far_color), 0.5);
        expected = glm::mix(expected, glm::dvec3(near_color), 0.25);
        EXPECT_LT(glm::distance(glm::dvec3(targets.radiance.at(48, 32)), expected), 1e-6) << near_first;
        EXPECT_EQ(glm::vec3(targets.radiance.at(16, 32)), glm::vec3(0.5f));
    }
}

/// A lit blended surface with full opacity is shaded as the deferred pass shades it.
TEST_P(LightingTest, BlendedAndOpaqueSurfacesAreShadedAlike) {
    std::vector<Picture> pictures;
    for (const bool blended : {false, true}) {
        scene::Scene scene;
        add_floor(scene, 8);
        scene::Material material{.base_color = {0.7f, 0.5f, 0.3f, 1}, .metallic = 0.4f, .roughness = 0.35f};
        material.emission = {0.1f, 0, 0.2f};
        material.double_sided = true;
        material.normal_texture = add_texel(scene, {150, 120, 240, 255});
        if (blended) material.alpha_mode = scene::AlphaMode::blend;
        add_quad(scene, {0, 1, 0}, {1, 0.2f, 0}, {0, -0.3f, -1}, material);
        const Sun sun{glm::normalize(glm::vec3(0.3f, 1, 0.4f)), glm::vec3(3)};
        const RenderedTargets targets = render(device(), scene, from_above(4), {.size = size, .sun = sun});
        pictures.push_back(targets.radiance);
    }
    // Half floats and 8-bit colour lie between them.
    for (const auto& [x, y] : {std::pair(40u, 30u), std::pair(48u, 32u), std::pair(56u, 36u)})
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(pictures[0].at(x, y)[c], pictures[1].at(x, y)[c], 0.012f * pictures[0].at(x, y)[c])
                << x << ", " << y;
}

TEST(LightCamera, HoldsTheBoundsTightly) {
    scene::Bounds bounds;
    bounds.add({-3, 0, 12});
    bounds.add({20, 7, 15});
    for (const glm::vec3 direction :
         {glm::vec3(0, 1, 0), glm::vec3(1, 0.01f, 0), glm::vec3(0.3f, 0.8f, -0.5f), glm::vec3(-5, -5, 5),
          glm::vec3(0, 0, 1)}) {
        const shadow::LightCamera camera = shadow::fit_light(bounds, direction, 512);
        EXPECT_NEAR(glm::length(camera.toward_light), 1, 1e-6);
        glm::vec3 lowest(2), highest(-2);
        for (int corner = 0; corner < 8; ++corner) {
            const glm::vec4 p(corner & 1 ? bounds.max.x : bounds.min.x,
                              corner & 2 ? bounds.max.y : bounds.min.y,
                              corner & 4 ? bounds.max.z : bounds.min.z, 1);
            const glm::vec4 clip = camera.clip_from_world * p;
            EXPECT_FLOAT_EQ(clip.w, 1);
            lowest = glm::min(lowest, glm::vec3(clip));
            highest = glm::max(highest, glm::vec3(clip));
            // Toward the light is toward depth 0.
            const glm::vec4 nearer = camera.clip_from_world * (p + glm::vec4(camera.toward_light, 0));
            EXPECT_LT(nearer.z, clip.z);
            EXPECT_NEAR(nearer.x, clip.x, 1e-5);
            EXPECT_LT(glm::distance(camera.world_from_clip * clip, p), 1e-3f);
        }
        // Two texels of margin on each side.
        for (int axis = 0; axis < 2; ++axis) {
            EXPECT_NEAR(lowest[axis], -1 + 2 * 2.0 / 512, 1e-4);
            EXPECT_NEAR(highest[axis], 1 - 2 * 2.0 / 512, 1e-4);
        }
        EXPECT_NEAR(lowest.z, 0, 2e-3);
        EXPECT_NEAR(highest.z, 1, 2e-3);
        EXPECT_GT(lowest.z, 0);
        EXPECT_LT(highest.z, 1);
        // A step of one texel in clip space is one texel's length in the world.
        const glm::vec4 step = camera.world_from_clip * glm::vec4(2.0f / 512, 0, 0, 0);
        EXPECT_NEAR(glm::length(step), camera.texel_size.x, 1e-5);
    }
}

}  // namespace
}  // namespace lumo::lighting
