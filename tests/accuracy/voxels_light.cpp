// The light of analytic lights in the voxels against closed forms: radiance, flux, shadow; and mips against the mean.
#include <fmt/format.h>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>
#include <random>

#include "scene/builtin/builtin.hpp"
#include "tests/support/device_test.hpp"
#include "tests/support/voxels.hpp"

namespace lumo {
namespace {

using namespace testing_support;

using VoxelLightTest = DeviceTest;
INSTANTIATE_TEST_SUITE_P(Accuracy, VoxelLightTest, both_apis, api_name);

constexpr glm::vec3 albedo{0.8f, 0.5f, 0.2f};
constexpr glm::vec3 irradiance{3, 2, 4};

struct Lit {
    /// Green, of occupied voxels that keep clear of the plane's edges, W/m²/sr: over their area, and over their number,
    /// which is what mips average. Areas are noisy and radiance is flux over area, so the second is a little higher.
    double mean_radiance = 0;
    double mean_of_voxels = 0;
    double flux = 0;  ///< green, leaving all voxels, W
    size_t voxels = 0;
};

/// What leaves the voxels; `inner` says which of them count for the mean.
template <class Inner>
Lit measure(rhi::Device& device, const Voxelized& voxelized, const Inner& inner) {
    const VolumeTexels area = read_volume(device, voxelized.volume.area());
    const VolumeTexels radiance = read_volume(device, voxelized.volume.radiance().base);
    const double face = double(voxelized.grid.voxel_size) * double(voxelized.grid.voxel_size);
    const double unit = double(voxelized.volume.view().radiance_unit);
    Lit lit;
    double inner_area = 0;
    for (int z = 0; z < area.side; ++z)
        for (int y = 0; y < area.side; ++y)
            for (int x = 0; x < area.side; ++x) {
                const glm::vec4& stored = radiance.at({x, y, z});
                if (stored.a == 0) continue;
                const double leaving = double(stored.g / stored.a) * unit;
                lit.flux += glm::pi<double>() * leaving * decode_area(area.at({x, y, z}).x) * face;
                const glm::dvec3 center = glm::dvec3(voxelized.grid.origin) +
                                          (glm::dvec3(x, y, z) + 0.5) * double(voxelized.grid.voxel_size);
                if (!inner(center)) continue;
                lit.mean_radiance += leaving * decode_area(area.at({x, y, z}).x);
                lit.mean_of_voxels += leaving;
                inner_area += decode_area(area.at({x, y, z}).x);
                ++lit.voxels;
            }
    lit.mean_radiance /= std::max(inner_area, 1e-30);
    lit.mean_of_voxels /= double(std::max<size_t>(lit.voxels, 1));
    return lit;
}

struct PlaneCase {
    std::string name;
    glm::mat4 turn{1};  ///< of a plane that faces +Y
};

TEST_P(VoxelLightTest, PlaneReflectsWhatItReceives) {
    const PlaneCase planes[] = {
        {"level", glm::mat4(1)},
        {"upright", glm::rotate(glm::mat4(1), glm::half_pi<float>(), glm::vec3(0, 0, 1))},
        {"at 45 degrees", glm::rotate(glm::mat4(1), glm::quarter_pi<float>(), glm::vec3(1, 0, 0))},
        {"tilted", glm::rotate(glm::mat4(1), 0.9f, glm::normalize(glm::vec3(1, 0.3f, 0.5f)))}};
    for (const PlaneCase& plane : planes) {
        scene::Scene scene;
        add(scene, scene::builtin::parallelogram({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}), diffuse(albedo),
            plane.turn);
        for (const double angle : {0.0, 30.0, 60.0, 80.0, 89.0}) {
            SCOPED_TRACE(fmt::format("{} plane, sun {} degrees from its normal", plane.name, angle));
            const double cosine = std::cos(glm::radians(angle));
            const glm::vec3 local(float(std::sin(glm::radians(angle)) * 0.6), float(cosine),
                                  float(std::sin(glm::radians(angle)) * 0.8));
            const glm::vec3 to_sun = glm::normalize(glm::vec3(plane.turn * glm::vec4(local, 0)));
            const Voxelized voxelized = voxelize(device(), scene,
                                                 {.resolution = 64,
                                                  .sun = Sun{to_sun, irradiance},
                                                  .shadow_resolution = 1024,
                                                  .range = voxels::Range::fixed});
            const glm::mat4 unturn = glm::inverse(plane.turn);
            const double margin = 1 - 2.5 * double(voxelized.grid.voxel_size);
            const Lit lit = measure(device(), voxelized, [&](glm::dvec3 center) {
                const glm::vec4 on_plane = unturn * glm::vec4(glm::vec3(center), 1);
                return std::max(std::abs(on_plane.x), std::abs(on_plane.z)) < float(margin);
            });
            const double flux = 4 * double(albedo.g) * double(irradiance.g) * cosine;
            const double radiance = flux / 4 / glm::pi<double>();
            EXPECT_NEAR(lit.flux, flux, 0.02 * flux);
            EXPECT_NEAR(lit.mean_radiance, radiance, 0.03 * radiance);
            EXPECT_NEAR(lit.mean_of_voxels, radiance, 0.05 * radiance);
            EXPECT_GT(lit.voxels, 1000u);
        }
    }
}

TEST_P(VoxelLightTest, BallReflectsTheFluxOfItsDisc) {
    constexpr double radius = 1;
    scene::Scene scene;
    add(scene, scene::builtin::sphere(float(radius), 96, 48), diffuse(albedo));
    for (const glm::vec3 to_sun : {glm::vec3(0, 1, 0), glm::vec3(-1, 0, 0), glm::vec3(0.3f, 0.5f, -0.7f)}) {
        SCOPED_TRACE(fmt::format("sun at {} {} {}", to_sun.x, to_sun.y, to_sun.z));
        for (const bool wide_range : {true, false}) {
            const Voxelized voxelized =
                voxelize(device(), scene,
                         {.resolution = 64,
                          .sun = Sun{glm::normalize(to_sun), irradiance},
                          .shadow_resolution = 1024,
                          .range = wide_range ? voxels::Range::fixed : voxels::Range::ldr});
            const Lit lit = measure(device(), voxelized, [](glm::dvec3) { return true; });
            const double expected =
                double(albedo.g) * double(irradiance.g) * glm::pi<double>() * radius * radius;
            EXPECT_NEAR(lit.flux, expected, 0.02 * expected) << (wide_range ? "half floats" : "8 bits");
        }
    }
}

/// The inside of a room of this half side, turned off the grid's axes.
scene::Scene room(float half) {
    scene::Scene scene;
    auto walls = scene::builtin::box(glm::vec3(-half), glm::vec3(half));
    add(scene, std::move(walls), diffuse(albedo),
        glm::rotate(glm::mat4(1), 0.4f, glm::normalize(glm::vec3(1, 2, 3))));
    return scene;
}

/// W of green that a light sends out: the integral of KHR_lights_punctual's cone.
double power_of(const scene::Light& light) {
    if (light.kind == scene::LightKind::point) return 4 * glm::pi<double>() * double(light.intensity.g);
    const double inner = std::cos(double(light.inner_cone_angle)),
                 outer = std::cos(double(light.outer_cone_angle));
    // 2 pi times the integral of ((c - outer) / (inner - outer))² between the angles, and of 1 within.
    return 2 * glm::pi<double>() * double(light.intensity.g) * ((inner - outer) / 3 + 1 - inner);
}

/// All that a light within a closed room sends out falls on its walls.
TEST_P(VoxelLightTest, RoomReceivesAllThatItsLightsSend) {
    const scene::Scene scene = room(1);
    const std::vector<scene::Light> one{
        {.kind = scene::LightKind::point, .intensity = {4, 2, 1}, .position = {0.3f, -0.2f, 0.1f}}};
    const std::vector<scene::Light> spot{{.kind = scene::LightKind::spot,
                                          .intensity = {1, 5, 2},
                                          .position = {-0.4f, 0.1f, 0.2f},
                                          .direction = glm::normalize(glm::vec3(1, 0.2f, -0.3f)),
                                          .inner_cone_angle = 0.3f,
                                          .outer_cone_angle = 0.8f}};
    // A light a thousand times dimmer is not lost beside the other.
    const std::vector<scene::Light> unequal{{.kind = scene::LightKind::point, .intensity = {4000, 0, 4000}},
                                            {.kind = scene::LightKind::point, .intensity = {0, 4, 0}}};
    std::vector<scene::Light> both = one;
    both.push_back(spot[0]);
    for (const auto& lights : {one, spot, unequal, both}) {
        double power = 0;
        for (const scene::Light& light : lights) power += power_of(light);
        const Voxelized voxelized = voxelize(
            device(), scene,
            {.resolution = 64, .lights = lights, .shadow_resolution = 512, .range = voxels::Range::fixed});
        const Lit lit = measure(device(), voxelized, [](glm::dvec3) { return true; });
        EXPECT_NEAR(lit.flux, double(albedo.g) * power, 0.03 * double(albedo.g) * power);
    }
}

/// A floor under a point light: irradiance falls as the cube of the cosine.
TEST_P(VoxelLightTest, FloorUnderAPointLight) {
    scene::Scene scene;
    add(scene, scene::builtin::parallelogram({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}), diffuse(albedo));
    const scene::Light light{
        .kind = scene::LightKind::point, .intensity = glm::vec3(3), .position = {0, 1, 0}};
    const Voxelized voxelized = voxelize(
        device(), scene,
        {.resolution = 64, .lights = {light}, .shadow_resolution = 512, .range = voxels::Range::fixed});
    for (const double radius : {0.0, 0.5, 1.0, 1.5}) {
        double expected = 0;
        int count = 0;
        const double band = 0.15;
        const Lit lit = measure(device(), voxelized, [&](glm::dvec3 p) {
            const double r = std::hypot(p.x, p.z);
            if (std::abs(r - radius) > band) return false;
            expected += 3 / std::pow(1 + r * r, 1.5) * double(albedo.g) / glm::pi<double>();
            ++count;
            return true;
        });
        expected /= count;
        EXPECT_NEAR(lit.mean_of_voxels, expected, 0.05 * expected) << radius;
    }
}

TEST_P(VoxelLightTest, NothingIsLitBehindAnOccluder) {
    scene::Scene scene;
    add(scene, scene::builtin::parallelogram({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}), diffuse(albedo));
    add(scene, scene::builtin::box({-0.5f, 1, -0.5f}, {0.5f, 1.4f, 0.5f}), diffuse(albedo));
    for (const glm::vec3 direction : {glm::vec3(0, 1, 0), glm::vec3(0.5f, 1, 0.3f), glm::vec3(-0.8f, 1, 0)}) {
        SCOPED_TRACE(fmt::format("sun at {} {} {}", direction.x, direction.y, direction.z));
        const Voxelized voxelized = voxelize(
            device(), scene,
            {.resolution = 64, .sun = Sun{glm::normalize(direction), irradiance}, .shadow_resolution = 1024});
        const VolumeTexels lit = read_volume(device(), voxelized.volume.direct_flux());
        const VolumeTexels radiance = read_volume(device(), voxelized.volume.radiance().base);
        const double voxel = double(voxelized.grid.voxel_size);
        int in_shadow = 0, in_light = 0, under_box = 0;
        for (int z = 0; z < lit.side; ++z)
            for (int y = 0; y < lit.side; ++y)
                for (int x = 0; x < lit.side; ++x) {
                    const glm::ivec3 v(x, y, z);
                    if (radiance.at(v).a == 0) continue;
                    const glm::dvec3 center =
                        glm::dvec3(voxelized.grid.origin) + (glm::dvec3(v) + 0.5) * voxel;
                    const bool floor = center.y < 0.3;
                    if (floor) {
                        // Where the ray to the sun passes the heights of the box.
                        bool shadowed = false, clear = true;
                        for (int i = 0; i <= 8; ++i) {
                            const double height = 1 + 0.05 * i;
                            const double px = center.x + height / double(direction.y) * double(direction.x);
                            const double pz = center.z + height / double(direction.y) * double(direction.z);
                            const double reach = std::max(std::abs(px), std::abs(pz));
                            shadowed |= reach < 0.5 - 1.5 * voxel;
                            clear &= reach > 0.5 + 1.5 * voxel;
                        }
                        if (shadowed) {
                            ++in_shadow;
                            EXPECT_EQ(lit.at(v).x, 0);
                            EXPECT_EQ(glm::vec3(radiance.at(v)), glm::vec3(0));
                        } else if (clear) {
                            ++in_light;
                            EXPECT_GT(lit.at(v).x, 0);
                        }
                    } else if (std::abs(center.y - 1) < voxel && std::abs(center.x) < 0.5 - 2 * voxel &&
                               std::abs(center.z) < 0.5 - 2 * voxel) {
                        ++under_box;
                        EXPECT_EQ(lit.at(v).x, 0) << "the box's underside at " << x << ' ' << y << ' ' << z;
                    }
                }
        EXPECT_GT(in_shadow, 100);
        EXPECT_GT(in_light, 1500);
        EXPECT_GT(under_box, 80);
    }
}

glm::vec4 mean_of_children(const VolumeTexels& finer, glm::ivec3 voxel) {
    glm::vec4 sum(0);
    for (int child = 0; child < 8; ++child)
        sum += finer.at(2 * voxel + glm::ivec3(child & 1, child >> 1 & 1, child >> 2));
    return sum / 8.0f;
}

/// What a ray along one of six directions, +x -x +y -y +z -z, sees of eight children: the nearer four over the farther
/// four. Mips of that kind lie side by side along x.
glm::vec4 seen_through_children(const VolumeTexels& finer, int direction, glm::ivec3 voxel) {
    const bool atlas = finer.width != finer.side;
    const int axis = direction / 2;
    const bool backward = direction % 2 == 1;
    glm::vec4 sum(0);
    for (int child = 0; child < 8; ++child) {
        glm::ivec3 near = 2 * voxel + glm::ivec3(child & 1, child >> 1 & 1, child >> 2);
        if ((near[axis] % 2 == 1) != backward) continue;
        glm::ivec3 far = near;
        far[axis] += backward ? -1 : 1;
        if (atlas) {
            near.x += direction * finer.side;
            far.x += direction * finer.side;
        }
        sum += finer.at(near) + (1 - finer.at(near).a) * finer.at(far);
    }
    return sum / 4.0f;
}

struct MipCase {
    voxels::MipKind kind;
    bool wide_range;
};

/// Compares each mip with what it should be, given the one above. Half a step of 8 bits is the tolerance, or a
/// unit in the last of 11 bits, because a driver may cut floats off when it stores halves.
void expect_mips(rhi::Device& device, const scene::Scene& scene, const MipCase& c) {
    const Voxelized voxelized =
        voxelize(device, scene,
                 {.resolution = 32,
                  .sun = Sun{-glm::normalize(scene.lights[0].direction), scene.lights[0].intensity},
                  .range = c.wide_range ? voxels::Range::fixed : voxels::Range::ldr,
                  .mips = c.kind});
    const voxels::LightVolume& light = voxelized.volume.radiance();
    const bool isotropic = c.kind == voxels::MipKind::isotropic;
    const rhi::Texture& mips = isotropic ? light.base : light.directions;
    VolumeTexels finer = read_volume(device, light.base);
    glm::dvec4 energy(0);  // of level 0
    for (const glm::vec4& texel : finer.texels) energy += glm::dvec4(texel);
    ASSERT_GT(energy.g, 10);

    double rounding = 0;  // what it can have added so far
    ASSERT_EQ(mips.desc().mips, isotropic ? 6u : 5u);
    for (uint32_t mip = isotropic ? 1 : 0; mip < mips.desc().mips; ++mip) {
        const VolumeTexels coarser = read_volume(device, mips, mip);
        const double children = std::pow(8.0, isotropic ? mip : mip + 1);
        size_t wrong = 0;
        glm::dvec4 sum(0);
        for (int z = 0; z < coarser.side; ++z)
            for (int y = 0; y < coarser.side; ++y)
                for (int x = 0; x < coarser.width; ++x) {
                    const glm::ivec3 voxel(x % coarser.side, y, z);
                    const glm::vec4 expected = isotropic
                                                   ? mean_of_children(finer, voxel)
                                                   : seen_through_children(finer, x / coarser.side, voxel);
                    const float largest = std::max({expected.r, expected.g, expected.b, expected.a});
                    const float tolerance = c.wide_range ? largest / 1024 + 1e-7f : 0.5001f / 255;
                    const glm::vec4 stored = coarser.at({x, y, z});
                    for (int channel = 0; channel < 4; ++channel)
                        wrong += std::abs(stored[channel] - expected[channel]) > tolerance;
                    sum += glm::dvec4(stored);
                    if (largest > 0) rounding += double(tolerance) * children;
                }
        EXPECT_EQ(wrong, 0u) << "mip " << mip;
        // A mean neither makes nor loses light. What is seen from one side is no part of the whole.
        for (int channel = 0; isotropic && channel < 4; ++channel) {
            const double here = sum[channel] * children;
            EXPECT_LE(here, energy[channel] + rounding) << "mip " << mip;
            if (c.wide_range) {
                EXPECT_NEAR(here, energy[channel], 2e-3 * energy[channel]) << "mip " << mip;
            }
        }
        finer = coarser;
    }
}

TEST_P(VoxelLightTest, MipsAreMeansOfWhatTheyCover) {
    const scene::Scene scene = without_textures(value_of(scene::make_builtin("atrium")));
    for (const voxels::MipKind kind : {voxels::MipKind::isotropic, voxels::MipKind::anisotropic})
        for (const bool wide_range : {false, true}) {
            SCOPED_TRACE(fmt::format("{}, {}",
                                     kind == voxels::MipKind::isotropic ? "isotropic" : "anisotropic",
                                     wide_range ? "half floats" : "8 bits"));
            expect_mips(device(), scene, {kind, wide_range});
        }
}

}  // namespace
}  // namespace lumo
