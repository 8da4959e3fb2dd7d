// The G-buffer of known surfaces against rays through pixel centres, in double precision.
#include "techniques/gbuffer/gbuffer.hpp"

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "shaders/test_accuracy/position.hpp"
#include "tests/support/device_test.hpp"
#include "tests/support/rendering.hpp"

namespace lumo::gbuffer {
namespace {

using namespace testing_support;

constexpr rhi::Extent size{96, 64};

struct GBufferTest : DeviceTest {
    Picture positions(const RenderedTargets& targets) {
        rhi::Texture depth = texture({.name = "depth", .format = rhi::Format::r32_float, .extent = size});
        std::vector<float> depths;
        for (const glm::vec4& texel : targets.depth.texels) depths.push_back(texel.x);
        testing_support::must(device().upload(depth, rhi::whole_mip(depth.desc()), bytes_of(depths)));
        rhi::Texture result = texture({.name = "positions",
                                       .format = rhi::Format::rgba32_float,
                                       .extent = size,
                                       .usage = rhi::TextureUsage::storage});
        auto pipeline = compute<shaders::test_accuracy::position>();
        const rhi::Sampler sampler = nearest_sampler();
        rhi::Commands commands = device().begin();
        const rhi::UniformBuffer camera = commands.uniform(targets.camera);
        commands.pass("positions")
            .dispatch(
                pipeline,
                {{depth.view<rhi::Dimension::d2>(), sampler}, camera, result.view<rhi::Dimension::d2>()}, {},
                rhi::groups_for(size, {8, 8}));
        value_of(device().wait(device().submit(std::move(commands))));
        return download(device(), result);
    }
};
INSTANTIATE_TEST_SUITE_P(Accuracy, GBufferTest, both_apis, api_name);

scene::Camera camera_at(glm::vec3 position, glm::vec3 target, float near_plane = 0.05f,
                        float far_plane = 1000) {
    scene::Camera camera;
    camera.position = position;
    camera.target = target;
    camera.near_plane = near_plane;
    camera.far_plane = far_plane;
    return camera;
}

/// A quad of half-sides 1 in the xy plane, placed by a matrix.
struct PlacedQuad {
    glm::dmat4 place;

    glm::dvec3 normal() const {
        return glm::normalize(glm::transpose(glm::inverse(glm::dmat3(place))) * glm::dvec3(0, 0, 1));
    }
    /// Where a ray meets its plane, in its own coordinates, with the distance in w.
    glm::dvec4 meet(const Ray& ray) const {
        const glm::dmat4 inverse = glm::inverse(place);
        const glm::dvec3 origin(inverse * glm::dvec4(ray.origin, 1)),
            direction(inverse * glm::dvec4(ray.direction, 0));
        const double distance = -origin.z / direction.z;
        return glm::dvec4(origin + distance * direction, distance);
    }
};

void expect_quad(GBufferTest& test, rhi::Device& device, const scene::Camera& camera, const glm::mat4& place,
                 const std::function<Picture(const RenderedTargets&)>& find_positions) {
    (void)test;
    scene::Scene scene;
    scene::Material material{.base_color = {0.8f, 0.4f, 0.1f, 1}, .metallic = 0.25f, .roughness = 0.6f};
    material.double_sided = true;
    add_quad(scene, glm::vec3(0), {1, 0, 0}, {0, 1, 0}, material, place);
    const RenderedTargets targets = render(device, scene, camera, {.size = size});
    const Picture positions = find_positions(targets);
    const PlacedQuad quad{glm::dmat4(place)};

    int covered = 0;
    for (uint32_t y = 0; y < size.height; ++y)
        for (uint32_t x = 0; x < size.width; ++x) {
            SCOPED_TRACE(testing::Message() << "pixel " << x << ", " << y);
            const Ray ray = pixel_ray(camera, size, x, y);
            const glm::dvec4 hit = quad.meet(ray);
            const double edge = 1 - std::max(std::abs(hit.x), std::abs(hit.y));
            if (std::abs(edge) < 1e-3) continue;  // its centre is on the border
            if (edge < 0 || hit.w <= 0) {
                ASSERT_EQ(targets.depth.at(x, y).x, 1);
                ASSERT_EQ(targets.normal_roughness.at(x, y), glm::vec4(0));
                continue;
            }
            ++covered;
            const glm::dvec3 expected = ray.origin + hit.w * ray.direction;
            // Four units of the depth's last place, and the rounding of the world coordinates.
            const double depth_error = hit.w * hit.w * std::exp2(-22) / double(camera.near_plane);
            const double rounding = 1e-6 * (hit.w + glm::length(expected));
            const double tolerance = camera.orthographic_height ? rounding : rounding + depth_error;
            ASSERT_LT(glm::distance(glm::dvec3(positions.at(x, y)), expected), tolerance);
            const glm::dvec3 normal =
                glm::dot(quad.normal(), ray.direction) < 0 ? quad.normal() : -quad.normal();
            // Half floats have 11 bits, and drivers may cut the rest off.
            ASSERT_LT(glm::distance(glm::dvec3(targets.normal_roughness.at(x, y)), normal), 1e-3);
            ASSERT_LT(glm::distance(glm::dvec3(targets.geometric_normal_occlusion.at(x, y)), normal), 1e-3);
            const glm::vec4 color = targets.base_color_metallic.at(x, y);
            for (int c = 0; c < 3; ++c)
                ASSERT_NEAR(srgb_encode(double(color[c])), srgb_encode(double(material.base_color[c])),
                            0.51 / 255);
            ASSERT_NEAR(color.a, 0.25f, 0.51f / 255);
            ASSERT_NEAR(targets.normal_roughness.at(x, y).w, 0.6f, 5e-4f);
            ASSERT_EQ(targets.geometric_normal_occlusion.at(x, y).w, 1);
        }
    EXPECT_GT(covered, 200);
}

TEST_P(GBufferTest, PositionsAndNormalsOfATiltedQuad) {
    glm::mat4 place = glm::rotate(glm::mat4(1), 0.7f, glm::normalize(glm::vec3(1, 2, 0.5f)));
    place = glm::scale(place, {1.5f, 0.8f, 3});
    const auto find = [this](const RenderedTargets& targets) { return positions(targets); };
    expect_quad(*this, device(), camera_at({0.3f, 0.2f, 4}, {0, 0, 0}), place, find);
    // From behind, mirrored, sheared.
    expect_quad(*this, device(), camera_at({0.3f, 0.2f, -4}, {0, 0, 0}), place, find);
    expect_quad(*this, device(), camera_at({0.3f, 0.2f, 4}, {0, 0, 0}), glm::scale(place, {-1, 1, 1}), find);
    glm::mat4 sheared = place;
    sheared[2] += 0.8f * place[0];
    sheared[1] += 0.3f * place[2];
    expect_quad(*this, device(), camera_at({0.3f, 0.2f, 4}, {0, 0, 0}), sheared, find);
}

TEST_P(GBufferTest, PositionsFarFromTheOriginAndFarAway) {
    const auto find = [this](const RenderedTargets& targets) { return positions(targets); };
    const glm::mat4 far_place = glm::scale(glm::translate(glm::mat4(1), {0, 0, -50}), glm::vec3(20, 15, 1));
    expect_quad(*this, device(), camera_at({1, 2, 3}, {0, 0, -50}), far_place, find);
    const glm::mat4 moved = glm::translate(glm::mat4(1), {20, -10, 30});
    expect_quad(*this, device(), camera_at({20.5f, -9, 34}, {20, -10, 30}), moved, find);
}

TEST_P(GBufferTest, OrthographicCamera) {
    scene::Camera camera = camera_at({1, 1, 5}, {0, 0, 0}, 0.1f, 20);
    camera.orthographic_height = 3.0f;
    expect_quad(*this, device(), camera, glm::mat4(1),
                [this](const RenderedTargets& targets) { return positions(targets); });
}

TEST_P(GBufferTest, TinyInstancesKeepTheirNormals) {
    const float tiny = 1e-12f;
    scene::Scene scene;
    add_quad(scene, glm::vec3(0), glm::vec3(1 / tiny, 0, 0), glm::vec3(0, 1 / tiny, 0), {},
             glm::scale(glm::mat4(1), glm::vec3(tiny)));
    const RenderedTargets targets = render(device(), scene, camera_at({0, 0, 2}, {0, 0, 0}), {.size = size});
    EXPECT_LT(glm::distance(glm::vec3(targets.normal_roughness.at(48, 32)), glm::vec3(0, 0, 1)), 1e-3f);
}

TEST_P(GBufferTest, SingleSidedFacesAreCulledAndMirrorsTurnTheWinding) {
    for (const bool mirrored : {false, true})
        for (const float side : {1.0f, -1.0f}) {
            scene::Scene scene;
            add_quad(scene, glm::vec3(0), {1, 0, 0}, {0, 1, 0}, {},
                     glm::scale(glm::mat4(1), {mirrored ? -1 : 1, 1, 1}));
            const RenderedTargets targets =
                render(device(), scene, camera_at({0, 0, 3 * side}, {0, 0, 0}), {.size = size});
            EXPECT_EQ(targets.depth.at(48, 32).x<1, side> 0) << "mirrored " << mirrored << " side " << side;
        }
}

/// A normal map whose only texel leans toward +u and +v (up in the image): MikkTSpace's frame in object space, then
/// to the world as a normal, is what every instance and face must show.
TEST_P(GBufferTest, NormalMapsLeanTheSameWayInMirrorsAndOnBackFaces) {
    const glm::dvec3 texel = 2.0 * glm::dvec3(179, 153, 217) / 255.0 - 1.0;
    for (const bool mirrored : {false, true})
        for (const double side : {1.0, -1.0}) {
            scene::Scene scene;
            scene::Material material;
            material.normal_texture = add_texel(scene, {179, 153, 217, 255});
            material.normal_scale = 0.5f;
            material.double_sided = true;
            glm::mat4 place = glm::rotate(glm::mat4(1), 0.4f, {0, 1, 0});
            place = glm::scale(place, {mirrored ? -2 : 2, 1, 1});
            add_quad(scene, glm::vec3(0), {1, 0, 0}, {0, 1, 0}, material, place);
            const RenderedTargets targets =
                render(device(), scene, camera_at({0, 0, 3 * float(side)}, {0, 0, 0}), {.size = size});
            // Tangent and bitangent go as directions of unit length, the normal as a normal.
            const glm::dmat3 m{glm::dmat4(place)};
            const glm::dvec3 t = glm::normalize(m * glm::dvec3(1, 0, 0)),
                             b = glm::normalize(m * glm::dvec3(0, 1, 0));
            const glm::dvec3 n = glm::normalize(glm::transpose(glm::inverse(m)) * glm::dvec3(0, 0, 1));
            const glm::dvec3 expected =
                side * glm::normalize(0.5 * texel.x * t + 0.5 * texel.y * b + texel.z * n);
            EXPECT_LT(glm::distance(glm::dvec3(targets.normal_roughness.at(48, 32)), expected), 1e-3)
                << "mirrored " << mirrored << " side " << side;
            EXPECT_LT(glm::distance(glm::dvec3(targets.geometric_normal_occlusion.at(48, 32)), side * n),
                      1e-3);
        }
}

TEST_P(GBufferTest, TexturesMultiplyTheirFactors) {
    scene::Scene scene;
    scene::Material material{.base_color = {0.5f, 0.5f, 0.5f, 1}, .metallic = 0.8f, .roughness = 0.5f};
    material.emission = {3, 2, 1};
    material.occlusion_strength = 0.5f;
    material.base_color_texture = add_texel(scene, {255, 128, 64, 255});
    material.metallic_roughness_texture = add_texel(scene, {9, 100, 200, 9});
    material.occlusion_texture = add_texel(scene, {51, 9, 9, 9});
    material.emission_texture = add_texel(scene, {255, 188, 0, 255});
    add_quad(scene, glm::vec3(0), {1, 0, 0}, {0, 1, 0}, material);
    for (scene::Vertex& vertex : scene.vertices) vertex.color = {0.25f, 1, 1, 1};
    const RenderedTargets targets = render(device(), scene, camera_at({0, 0, 3}, {0, 0, 0}), {.size = size});
    const glm::vec4 color = targets.base_color_metallic.at(48, 32);
    const double expected[] = {0.5 * 0.25, 0.5 * srgb_decode(128 / 255.0), 0.5 * srgb_decode(64 / 255.0)};
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(srgb_encode(double(color[c])), srgb_encode(expected[c]), 0.7 / 255) << c;
    EXPECT_NEAR(color.a, 0.8 * 200 / 255, 0.51 / 255);
    EXPECT_NEAR(targets.normal_roughness.at(48, 32).w, 0.5 * 100 / 255, 2.5e-4);
    EXPECT_NEAR(targets.geometric_normal_occlusion.at(48, 32).w, 1 + 0.5 * (0.2 - 1), 5e-4);
    const glm::vec4 emission = targets.emission.at(48, 32);
    EXPECT_NEAR(emission.r, 3, 3e-3);
    EXPECT_NEAR(emission.g, 2 * srgb_decode(188 / 255.0), 4e-3);
    EXPECT_EQ(emission.b, 0);
    // Where nothing is drawn nothing emits.
    EXPECT_EQ(glm::vec3(targets.emission.at(1, 1)), glm::vec3(0));
}

TEST_P(GBufferTest, DiffuseMaterialsAreNeitherMetalNorBumpy) {
    scene::Scene scene;
    scene::Material material;
    material.normal_texture = add_texel(scene, {255, 128, 128, 255});
    material.occlusion_texture = add_texel(scene, {0, 0, 0, 0});
    add_quad(scene, glm::vec3(0), {1, 0, 0}, {0, 1, 0}, material);
    const RenderedTargets targets =
        render(device(), scene, camera_at({0, 0, 3}, {0, 0, 0}), {.size = size, .diffuse_materials = true});
    EXPECT_EQ(targets.base_color_metallic.at(48, 32).a, 0);
    EXPECT_EQ(glm::vec3(targets.normal_roughness.at(48, 32)), glm::vec3(0, 0, 1));
    EXPECT_EQ(targets.geometric_normal_occlusion.at(48, 32).w, 1);
}

/// The left half of a texture is cut out; KHR_texture_transform and the second uv set move the cut.
TEST_P(GBufferTest, AlphaMaskCutsWhereTheTextureSays) {
    for (const bool moved : {false, true}) {
        scene::Scene scene;
        scene::Material material{.alpha_mode = scene::AlphaMode::mask};
        material.base_color_texture = add_texel(scene, {});
        scene.images[0] = {2, 1, 4, {255, 255, 255, 0, 255, 255, 255, 255}};
        scene.textures[0].sampler = {.magnification = scene::Filter::nearest,
                                     .minification = scene::Filter::nearest,
                                     .mip = {},
                                     .wrap_u = scene::Wrap::clamp_to_edge};
        if (moved) {
            material.base_color_texture->uv_set = 1;
            material.base_color_texture->uv_transform = glm::mat3(1, 0, 0, 0, 1, 0, 0.25f, 0, 1);
        }
        add_quad(scene, glm::vec3(0), {1, 0, 0}, {0, 1, 0}, material);
        if (moved)
            for (scene::Vertex& vertex : scene.vertices) vertex.uv0 = glm::vec2(0);
        const scene::Camera camera = camera_at({0, 0, 3}, {0, 0, 0});
        const RenderedTargets targets = render(device(), scene, camera, {.size = size});
        const PlacedQuad quad{glm::dmat4(1)};
        const double cut = moved ? -0.5 : 0;
        for (uint32_t y = 0; y < size.height; ++y)
            for (uint32_t x = 0; x < size.width; ++x) {
                const glm::dvec4 hit = quad.meet(pixel_ray(camera, size, x, y));
                if (std::abs(hit.x) > 0.99 || std::abs(hit.y) > 0.99 || std::abs(hit.x - cut) < 1e-3)
                    continue;
                ASSERT_EQ(targets.depth.at(x, y).x<1, hit.x> cut) << x << ", " << y << " moved " << moved;
            }
    }
}

/// A checkerboard of texels as small as pixels reads as its mean, also across the diagonal between the two triangles.
TEST_P(GBufferTest, MinificationIsSeamless) {
    scene::Scene scene;
    scene::Material material;
    material.base_color_texture = add_texel(scene, {});
    constexpr uint32_t side = 512;
    scene::Image8 board{side, side, 4, std::vector<uint8_t>(size_t(side) * side * 4, 255)};
    for (uint32_t y = 0; y < side; ++y)
        for (uint32_t x = 0; x < side; ++x)
            // Fine stripes inside broad ones: the broad ones show if the mip is right.
            for (int c = 0; c < 3; ++c) board.at(x, y)[c] = x / 64 % 2 == 0 ? uint8_t((x + y) % 2 * 255) : 0;
    scene.images[0] = board;
    add_quad(scene, glm::vec3(0), {1, 0, 0}, {0, 1, 0}, material);
    const scene::Camera camera = camera_at({0, 0, 2.6f}, {0, 0, 0});
    const RenderedTargets targets = render(device(), scene, camera, {.size = size});
    const PlacedQuad quad{glm::dmat4(1)};
    int looked_at = 0;
    for (uint32_t y = 0; y < size.height; ++y)
        for (uint32_t x = 0; x < size.width; ++x) {
            const glm::dvec4 hit = quad.meet(pixel_ray(camera, size, x, y));
            const double u = 4 * (hit.x + 1);  // in stripes' widths
            const double in_stripe = u - std::floor(u);
            if (std::abs(hit.x) > 0.97 || std::abs(hit.y) > 0.97 || std::abs(in_stripe - 0.5) > 0.1) continue;
            ++looked_at;
            const float expected = int(std::floor(u)) % 2 == 0 ? 0.5f : 0.0f;
            ASSERT_NEAR(targets.base_color_metallic.at(x, y).x, expected, 0.03) << x << ", " << y;
        }
    EXPECT_GT(looked_at, 100);
}

}  // namespace
}  // namespace lumo::gbuffer
