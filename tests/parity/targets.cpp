// What the rasterizer fills: the G-buffer and the shadow map are the same bits from both APIs on drivers that share a
// rasterizer, so that what differs later is traced to where it began.
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>
#include <random>

#include "scene/builtin/builtin.hpp"
#include "tests/support/both_apis.hpp"
#include "tests/support/rendering.hpp"

namespace lumo {
namespace {

using namespace testing_support;

struct TargetParityTest : BothApisTest {
    /// Texels that differ by more than `tolerance` of the larger magnitude or of 1e-3.
    static size_t differing(const Picture& a, const Picture& b, float tolerance) {
        EXPECT_EQ(a.texels.size(), b.texels.size());
        size_t count = 0;
        for (size_t i = 0; i < a.texels.size(); ++i) {
            bool differs = false;
            for (int c = 0; c < 4; ++c) {
                const float x = a.texels[i][c], y = b.texels[i][c];
                differs |= !(std::abs(x - y) <= tolerance * std::max({std::abs(x), std::abs(y), 1e-3f}));
            }
            count += differs;
        }
        return count;
    }

    void expect_same(const scene::Scene& scene, const scene::Camera& camera, RenderOptions options) {
        const RenderedTargets a = render(gl(), scene, camera, options),
                              b = render(vulkan(), scene, camera, options);
        const bool same_rasterizer = gl().info().software && vulkan().info().software;
        const auto expect_bits = [&](const char* name, const Picture& x, const Picture& y) {
            const double allowed = same_rasterizer ? 0 : 1e-3 * double(x.texels.size());
            EXPECT_LE(double(differing(x, y, same_rasterizer ? 0 : 1e-3f)), allowed) << name;
        };
        expect_bits("base colour", a.base_color_metallic, b.base_color_metallic);
        expect_bits("normal", a.normal_roughness, b.normal_roughness);
        expect_bits("geometric normal", a.geometric_normal_occlusion, b.geometric_normal_occlusion);
        expect_bits("emission", a.emission, b.emission);
        expect_bits("depth", a.depth, b.depth);
        expect_bits("shadow map", a.shadow, b.shadow);
        const double allowed = (same_rasterizer ? 1e-4 : 1e-3) * double(a.radiance.texels.size());
        EXPECT_LE(double(differing(a.radiance, b.radiance, same_rasterizer ? 1e-4f : 1e-3f)), allowed);
    }
};

TEST_F(TargetParityTest, Atrium) {
    const scene::Scene scene = testing_support::must(scene::make_builtin("atrium"));
    expect_same(
        scene, scene::default_camera(scene),
        {.size = {240, 135}, .sun = Sun{{0.3f, 1, 0.25f}, glm::vec3(5)}, .shadow = {.resolution = 1024}});
}

/// Everything at once, at random: mirrors, shears, masks, blends, normal maps, emission, both sides, small textures.
TEST_F(TargetParityTest, RandomQuads) {
    std::mt19937 random(11);
    std::uniform_real_distribution<float> uniform(0, 1);
    const auto direction = [&] {
        return glm::normalize(glm::vec3(uniform(random), uniform(random), uniform(random)) - 0.5f);
    };
    scene::Scene scene;
    for (int i = 0; i < 60; ++i) {
        scene::Material material{.base_color = {uniform(random), uniform(random), uniform(random), 1},
                                 .metallic = uniform(random),
                                 .roughness = uniform(random)};
        material.double_sided = random() % 2;
        if (random() % 4 == 0) material.emission = {uniform(random), 0, uniform(random)};
        const auto noise = [&] {
            const scene::TextureSlot slot = add_texel(scene, {});
            scene::Image8& image = scene.images.back();
            image = {16, 8, 4, std::vector<uint8_t>(16 * 8 * 4)};
            for (uint8_t& v : image.values) v = uint8_t(random());
            return slot;
        };
        if (random() % 2) material.base_color_texture = noise();
        if (random() % 2) material.normal_texture = noise();
        if (random() % 2) material.metallic_roughness_texture = noise();
        if (material.base_color_texture) {
            material.alpha_mode = scene::AlphaMode(random() % 3);
            material.base_color.a = 0.8f;
        }
        glm::mat4 place = glm::translate(glm::mat4(1), 3.0f * direction());
        place = glm::rotate(place, 6 * uniform(random), direction());
        place = glm::scale(place, {random() % 2 ? 1 : -1, 0.5f + uniform(random), 1});
        place[1] += 0.4f * uniform(random) * place[0];
        add_quad(scene, glm::vec3(0), {1, 0, 0}, {0, 1, 0}, material, place);
    }
    scene::Camera camera;
    camera.position = {1, 2, 9};
    camera.target = {0, 0, 0};
    for (const glm::vec3 sun : {glm::vec3(0.2f, 1, 0.3f), glm::vec3(-1, 0.1f, 0.4f)})
        expect_same(scene, camera,
                    {.size = {240, 135}, .sun = Sun{sun, glm::vec3(5)}, .shadow = {.resolution = 512}});
}

}  // namespace
}  // namespace lumo
