// The sky in a frame against the numbers of the atmosphere that it is made of: what pixels see, what the map holds, and
// what cones make of it.
#include "techniques/sky/sky.hpp"

#include <cmath>
#include <fmt/format.h>
#include <glm/gtc/constants.hpp>
#include <gtest/gtest.h>
#include <numeric>

#include "reference/path_tracer.hpp"
#include "scene/builtin/builtin.hpp"
#include "scene/builtin/geometry.hpp"
#include "scene/sky.hpp"
#include "techniques/atmosphere/stored.hpp"
#include "techniques/frame/render.hpp"
#include "tests/support/device_test.hpp"
#include "tests/support/voxels.hpp"

namespace lumo {
namespace {

using namespace testing_support;
using atmosphere::Quantity;
using atmosphere::Question;
using frame::Layer;

constexpr double pi = glm::pi<double>();
constexpr double degree = pi / 180;

sky::Settings quick() { return {.tables = atmosphere::settings_of(atmosphere::Preset::fast)}; }

glm::vec3 sun_at(double zenith_deg) {
    return glm::vec3(std::sin(zenith_deg * degree), std::cos(zenith_deg * degree), 0);
}

struct SkyTest : DeviceTest {
    /// Answers to questions about Earth in linear Rec. 709.
    std::vector<glm::dvec3> ask(const std::vector<Question>& questions) {
        const scene::Atmosphere air = scene::earth();
        const auto tables =
            must(atmosphere::stored_or_precomputed(device(), air, quick().tables, rhi::DiskCache::of_user()));
        const auto probe = must(atmosphere::Probe::create(device()));
        const auto answers = must(probe.ask(device(), tables, questions));
        const auto weights = scene::rgb_weights(air.wavelengths_nm);
        std::vector<glm::dvec3> colors;
        for (size_t i = 0; i < answers.size(); ++i) {
            // Transmittance is that of sunlight.
            const bool part = questions[i].quantity == Quantity::transmittance_segment;
            glm::dvec3 sum(0), sunlight(0);
            for (size_t w = 0; w < weights.size(); ++w) {
                sum += weights[w] * double(answers[i][w]) * (part ? air.sun_irradiance[w] : 1);
                sunlight += weights[w] * air.sun_irradiance[w];
            }
            colors.push_back(glm::max(part ? sum / sunlight : sum, 0.0));
        }
        return colors;
    }
    glm::dvec3 ask(const Question& question) { return ask(std::vector{question})[0]; }

    frame::Rendered render(const scene::Scene& scene, const scene::Camera& camera, std::vector<Layer> layers,
                           rhi::Extent size = {32, 18}) {
        frame::Settings settings{.size = size,
                                 .diffuse_materials = true,
                                 .layers = std::move(layers),
                                 .voxels = {.resolution = 32},
                                 .sky = quick()};
        return must(frame::render(device(), scene, camera, settings));
    }
};
INSTANTIATE_TEST_SUITE_P(Accuracy, SkyTest, both_apis, api_name);

/// Looks at Earth's sky where nothing is before it, many times with the same tables.
class Window {
  public:
    Window(rhi::Device& device, rhi::Extent size)
        : device_(device),
          size_(size),
          nothing_(must(scene::GpuScene::create(device, {}, true))),
          gbuffer_(must(gbuffer::GBuffer::create(device, size, gbuffer::needs_of(nothing_.view(), true)))),
          sky_(must(sky::Sky::create(device, scene::earth(), quick()))) {
        must(sky_.create_pixels(device, size));
    }

    /// Row 0 is the bottom.
    Picture look(const scene::Sky& sky, const scene::Camera& camera) {
        rhi::Commands commands = device_.begin();
        const gbuffer::View seen =
            gbuffer_.record(commands, nothing_.view(), gbuffer::camera_block(camera, size_));
        sky_.record_pixels(commands, seen, sky, camera);
        must(device_.wait(device_.submit(std::move(commands))));
        return download(device_, sky_.radiance());
    }

  private:
    rhi::Device& device_;
    rhi::Extent size_;
    scene::GpuScene nothing_;
    gbuffer::GBuffer gbuffer_;
    sky::Sky sky_;
};

/// At an altitude, looking at a zenith angle and an azimuth from the sun's, which is at +x.
scene::Camera camera_at(double altitude_km, double zenith_deg, double azimuth_deg = 0,
                        double fov_deg = 0.01) {
    const glm::dvec3 way(std::sin(zenith_deg * degree) * std::cos(azimuth_deg * degree),
                         std::cos(zenith_deg * degree),
                         std::sin(zenith_deg * degree) * std::sin(azimuth_deg * degree));
    const glm::dvec3 position(0, 1000 * altitude_km, 0);
    // Far enough that the direction survives the float.
    const double reach = 1e3 * (1 + altitude_km);
    return {.position = glm::vec3(position),
            .target = glm::vec3(position + reach * way),
            .vertical_fov = float(fov_deg * degree),
            .near_plane = 0.1f,
            .far_plane = 1e6f};
}

glm::dvec3 pixel(const scene::ImageF& image, uint32_t x, uint32_t y) {
    const float* value = image.at(x, y);
    return {value[0], value[1], value[2]};
}

glm::dvec3 mean_of(const scene::ImageF& image) {
    glm::dvec3 sum(0);
    for (uint32_t y = 0; y < image.height; ++y)
        for (uint32_t x = 0; x < image.width; ++x) sum += pixel(image, x, y);
    return sum / double(image.width * image.height);
}

void expect_near(glm::dvec3 value, glm::dvec3 expected, double relative) {
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(value[c], expected[c], relative * std::max({expected.r, expected.g, expected.b})) << c;
}

TEST_P(SkyTest, PixelsAreTheAtmospheresRadiance) {
    Window window(device(), {1, 1});
    for (const double sun : {10.0, 85.0, 94.0}) {
        for (const auto& [altitude, zenith, azimuth] : {std::tuple(0.002, 30.0, 40.0),
                                                        {0.002, 89.0, 170.0},
                                                        {10.0, 91.0, 60.0},
                                                        {400.0, 109.0, 20.0}}) {
            SCOPED_TRACE(fmt::format("sun {}, {} km, view {} {}", sun, altitude, zenith, azimuth));
            const Picture seen =
                window.look({.direction_to_sun = sun_at(sun)}, camera_at(altitude, zenith, azimuth));
            expect_near(glm::dvec3(seen.texels[0]),
                        ask({.altitude_km = altitude,
                             .view_zenith_deg = zenith,
                             .sun_zenith_deg = sun,
                             .azimuth_deg = azimuth,
                             .quantity = Quantity::radiance}),
                        2e-3);
        }
    }
}

/// Straight down the ground is seen through the air.
TEST_P(SkyTest, GroundIsLitBySunAndSky) {
    scene::Scene scene;
    set_sky(scene, {.direction_to_sun = sun_at(40)});
    const auto rendered = render(scene, camera_at(400, 180), {Layer::radiance}, {1, 1});
    const Question down{.altitude_km = 400, .view_zenith_deg = 180, .sun_zenith_deg = 40, .distance_km = 400};
    const auto of = [&](Quantity quantity, double altitude) {
        Question question = down;
        question.quantity = quantity;
        question.altitude_km = altitude;
        return ask(question);
    };
    const glm::dvec3 reflected = 0.1 / pi *
                                 (of(Quantity::sun_irradiance, 0) + of(Quantity::sky_irradiance, 0)) *
                                 of(Quantity::transmittance_segment, 400);
    // Products of colours are not colours of products, but near them.
    expect_near(pixel(rendered.layers[0].linear, 0, 0), of(Quantity::radiance, 400) + reflected, 0.02);
}

/// The disc holds the light that its directional light gives, is darker at its limb, and is cut by the horizon.
TEST_P(SkyTest, SunsDiscHoldsTheSunsIrradiance) {
    constexpr uint32_t side = 48;
    constexpr double fov = 0.8;
    for (const double zenith : {0.0, 60.0, 85.0}) {
        SCOPED_TRACE(zenith);
        scene::Scene scene;
        set_sky(scene, {.direction_to_sun = sun_at(zenith)});
        const auto rendered =
            render(scene, camera_at(0, std::max(zenith, 1e-4), 0, fov), {Layer::radiance}, {side, side});
        const scene::ImageF& image = rendered.layers[0].linear;
        const glm::dvec3 around = pixel(image, 0, 0);
        glm::dvec3 sum(0);
        for (uint32_t y = 0; y < side; ++y)
            for (uint32_t x = 0; x < side; ++x) sum += pixel(image, x, y) - around;
        const double pixel_angle = 2 * std::tan(0.5 * fov * degree) / side;
        // What is scattered close to the sun is brighter than in the corner: a part in a thousand of the disc.
        expect_near(sum * (pixel_angle * pixel_angle), glm::dvec3(scene.lights[0].intensity), 0.01);

        const glm::dvec3 middle = pixel(image, side / 2, side / 2);
        const uint32_t limb = side / 2 + uint32_t(0.9 * 0.2678 * degree / pixel_angle);
        const glm::dvec3 near_limb = pixel(image, limb, side / 2);
        EXPECT_LT(near_limb.g, 0.75 * middle.g);
        EXPECT_LT(near_limb.b / middle.b, near_limb.r / middle.r) << "the limb is redder";
    }
    scene::Scene setting;
    set_sky(setting, {.direction_to_sun = sun_at(90)});
    const auto rendered = render(setting, camera_at(0, 90, 0, fov), {Layer::radiance}, {side, side});
    const scene::ImageF& image = rendered.layers[0].linear;
    EXPECT_GT(pixel(image, side / 2, side / 2 - 6).r, 100 * pixel(image, side / 2, side / 2 + 6).r);
}

TEST_P(SkyTest, AirLiesBeforeSurfaces) {
    for (const double distance : {1.0, 20.0}) {
        SCOPED_TRACE(distance);
        scene::Scene scene;
        const glm::vec3 emission(3, 2, 1);
        add(scene,
            scene::builtin::parallelogram({float(1000 * distance), 200, -1000}, {0, 0, 2000}, {0, 3000, 0}),
            scene::Material{
                .base_color = {0, 0, 0, 1}, .metallic = 0, .emission = emission, .double_sided = true});
        set_sky(scene, {.direction_to_sun = sun_at(50)});
        // Where all that is seen is near, few nodes of the quadrature are taken.
        scene::Camera camera = camera_at(1, 90, 0);
        if (distance < 1.5) camera.far_plane = 1500;
        const auto rendered =
            render(scene, camera, {Layer::radiance, Layer::direct, Layer::emission}, {1, 1});
        const Question question{.altitude_km = 1,
                                .view_zenith_deg = 90,
                                .sun_zenith_deg = 50,
                                .distance_km = distance,
                                .quantity = Quantity::inscatter};
        Question through = question;
        through.quantity = Quantity::transmittance_segment;
        expect_near(pixel(rendered.layers[0].linear, 0, 0),
                    ask(question) + glm::dvec3(emission) * ask(through), 3e-3);
        EXPECT_EQ(rendered.layers[2].linear.values, (std::vector<float>{3, 2, 1})) << "of the surface itself";
    }
}

/// A wall of light across the view, 20 km away, which hides so much of what lies behind it.
scene::Scene wall_of_light(float opacity, scene::Atmosphere air = scene::earth()) {
    scene::Scene scene;
    add(scene, scene::builtin::parallelogram({20e3f, 200, -1000}, {0, 0, 2000}, {0, 3000, 0}),
        scene::Material{.base_color = {0, 0, 0, opacity},
                        .metallic = 0,
                        .emission = {3, 2, 1},
                        .alpha_mode = opacity < 1 ? scene::AlphaMode::blend : scene::AlphaMode::opaque,
                        .double_sided = true});
    set_sky(scene, {.atmosphere = std::move(air), .direction_to_sun = sun_at(50)});
    return scene;
}

/// Two ways to the same picture: tables in single precision, and quadrature and paths in double.
TEST_P(SkyTest, ThePathTracerSeesTheSameSkyAndAir) {
    scene::Scene scene = wall_of_light(1);
    // The lower half is a wall far away, the upper one sky.
    const scene::Camera camera{.position = {0, 3200, 0},
                               .target = {20e3f, 3200, 0},
                               .vertical_fov = 0.02f,
                               .near_plane = 0.1f,
                               .far_plane = 1e6f};
    constexpr uint32_t side = 4;
    const scene::ImageF drawn = render(scene, camera, {Layer::radiance}, {side, side}).layers[0].linear;
    const auto traced = reference::path_trace(
        scene, camera,
        {.width = side, .height = side, .spp = 2, .pixel_centers_only = true, .air_paths = 200});
    ASSERT_TRUE(traced);
    for (const uint32_t y : {0u, side - 1}) {
        glm::dvec3 of_tables(0), of_paths(0);
        for (uint32_t x = 0; x < side; ++x) {
            of_tables += pixel(drawn, x, y) / double(side);
            of_paths += pixel(traced->layers[0].mean, x, y) / double(side);
        }
        expect_near(of_tables, of_paths, 0.02);
    }
    EXPECT_GT(glm::distance(pixel(drawn, 0, 0), pixel(drawn, 0, side - 1)), 1.0) << "they differ";
}

/// Also where pixels are as large as the disc, in the mean over where they lie.
TEST_P(SkyTest, SunsDiscIsNotLostBetweenPixels) {
    constexpr uint32_t side = 8, looks = 6;
    Window window(device(), {side, side});
    const double zenith = 20;
    const scene::Sky sky{.direction_to_sun = sun_at(zenith)};
    const glm::dvec3 irradiance(scene::sun_light(sky).intensity);
    for (const double pixel_deg : {0.1, 0.3, 0.6}) {
        SCOPED_TRACE(pixel_deg);
        const double fov = 2 * std::atan(0.5 * side * pixel_deg * degree) / degree;
        glm::dvec3 sum(0);
        for (uint32_t i = 0; i < looks * looks; ++i) {
            const glm::dvec2 offset = (glm::dvec2(i % looks, i / looks) + 0.5) / double(looks) * pixel_deg;
            const Picture seen = window.look(
                sky, camera_at(0.1, zenith + offset.x, offset.y / std::sin(zenith * degree), fov));
            for (const glm::vec4& texel : seen.texels) sum += glm::dvec3(texel - seen.texels[0]);
        }
        // Some hundred samples of a disc with a sharp edge.
        expect_near(sum * std::pow(pixel_deg * degree, 2) / double(looks * looks), irradiance, 0.03);
    }
}

TEST_P(SkyTest, AirLiesBeforeBlendedSurfaces) {
    const auto seen = [&](float opacity, bool gi) {
        const scene::Scene scene = wall_of_light(opacity);
        frame::Settings settings{.size = {2, 1},
                                 .gi = gi,
                                 .diffuse_materials = true,
                                 .layers = {Layer::radiance},
                                 .voxels = {.resolution = 16},
                                 .sky = quick()};
        const auto rendered = must(frame::render(device(), scene, camera_at(1, 90), settings));
        return pixel(rendered.layers[0].linear, 0, 0);
    };
    // Thick but for a part that no float tells from none, it is as an opaque one; else a mean of that and nothing.
    const glm::dvec3 opaque = seen(1, false), clear = seen(0, false);
    expect_near(seen(0.999999f, false), opaque, 1e-5);
    expect_near(seen(0.25f, false), 0.25 * opaque + 0.75 * clear, 1e-5);
    expect_near(seen(0.999999f, true), seen(1, true), 1e-5);
    EXPECT_GT(glm::distance(opaque, glm::dvec3(3, 2, 1)), 1) << "the air is seen at all";
}

/// Six wavelengths are two sets of tables; the air of both is one.
TEST_P(SkyTest, AirOfManyWavelengthsLiesBeforeBlendedSurfaces) {
    scene::Atmosphere air = scene::earth();
    const auto six = [](scene::Spectrum& spectrum) {
        const double red = spectrum.at(0), green = spectrum.at(1), blue = spectrum.at(2);
        spectrum = {red, 0.5 * (red + green), green, 0.5 * (green + blue), blue, 0.9 * blue};
    };
    six(air.sun_irradiance);
    six(air.rayleigh->scattering_per_km);
    six(air.mie->scattering_per_km);
    six(air.mie->extinction_per_km);
    six(air.ozone->extinction_per_km);
    six(air.ground_albedo);
    air.wavelengths_nm = {680, 615, 550, 495, 440, 430};
    frame::Settings settings{.size = {2, 1}, .gi = false, .layers = {Layer::radiance}, .sky = quick()};
    settings.sky.tables = sky::least_settings().tables;
    const auto seen = [&](float opacity) {
        const auto rendered =
            must(frame::render(device(), wall_of_light(opacity, air), camera_at(1, 90), settings));
        return pixel(rendered.layers[0].linear, 0, 0);
    };
    const glm::dvec3 opaque = seen(1);
    expect_near(seen(0.999999f), opaque, 1e-5);
    expect_near(seen(0.25f), 0.25 * opaque + 0.75 * seen(0), 1e-5);
}

/// Level 0 is the sky as its irradiance has it; the others are its means over cones.
TEST_P(SkyTest, MapHasTheSkysIrradianceAndItsConesMeans) {
    for (const double zenith : {30.0, 80.0}) {
        SCOPED_TRACE(zenith);
        const scene::Sky scene_sky{.direction_to_sun = sun_at(zenith)};
        auto sky = must(sky::Sky::create(device(), scene_sky.atmosphere, quick()));
        rhi::Commands commands = device().begin();
        sky.record_map(commands, scene_sky);
        must(device().wait(device().submit(std::move(commands))));
        constexpr uint32_t rows = 256;
        const scene::ImageF map = must(sky::download_map(device(), sky, rows));
        const auto each_direction = [&](const auto& take) {
            for (uint32_t y = 0; y < rows; ++y) {
                for (uint32_t x = 0; x < 2 * rows; ++x) {
                    const double polar = pi * (y + 0.5) / rows, azimuth = pi * (x + 0.5) / rows;
                    take(glm::dvec3(std::sin(polar) * std::cos(azimuth), std::cos(polar),
                                    std::sin(polar) * std::sin(azimuth)),
                         pixel(map, x, y), std::sin(polar) * (pi / rows) * (pi / rows));
                }
            }
        };
        glm::dvec3 irradiance(0);
        each_direction([&](glm::dvec3 direction, glm::dvec3 radiance, double solid_angle) {
            irradiance += radiance * std::max(direction.y, 0.0) * solid_angle;
        });
        expect_near(irradiance, ask({.sun_zenith_deg = zenith, .quantity = Quantity::sky_irradiance}), 0.02);

        for (uint32_t level = 1; level < 5; ++level) {
            SCOPED_TRACE(level);
            const auto bytes = must(device().download(sky.map(), rhi::whole_mip(sky.map().desc(), level)));
            const auto texels = values_of<glm::vec4>(bytes);
            const uint32_t side = 128 >> level;
            const double half_sine = 0.0828 * double(1u << (level - 1));
            const double cosine = 1 - 2 * half_sine * half_sine;
            // Up, along the slope between axes, and toward the sun's side; by shaders/sky/octahedron.glsl.
            for (const glm::dvec2 at : {glm::dvec2(0.5, 0.5), {0.3, 0.6}, {0.8, 0.5}, {0.95, 0.9}}) {
                const glm::uvec2 texel(glm::round(at * double(side - 1)));
                const glm::dvec2 place = 2.0 * glm::dvec2(texel) / double(side - 1) - 1.0;
                const double height = 1 - std::abs(place.x) - std::abs(place.y);
                const glm::dvec2 folded = height >= 0
                                              ? place
                                              : glm::dvec2((1 - std::abs(place.y)) * (place.x < 0 ? -1 : 1),
                                                           (1 - std::abs(place.x)) * (place.y < 0 ? -1 : 1));
                const glm::dvec3 axis = glm::normalize(glm::dvec3(folded.x, height, folded.y));
                glm::dvec3 sum(0);
                double weight = 0;
                each_direction([&](glm::dvec3 direction, glm::dvec3 radiance, double solid_angle) {
                    if (glm::dot(direction, axis) < cosine) return;
                    sum += radiance * solid_angle;
                    weight += solid_angle;
                });
                expect_near(glm::dvec3(texels[texel.y * side + texel.x]), sum / weight, 0.04);
            }
        }
    }
}

/// What a level plane without voxels gathers is the mean of the map over each cone's circle, weighted as distribute()
/// says. How far that is from the sky's irradiance is the cones' own, and with the voxels of the plane what these hide.
TEST_P(SkyTest, ConesGatherTheSkysIrradiance) {
    scene::Scene scene;
    add(scene, scene::builtin::parallelogram({-5, 0, 5}, {10, 0, 0}, {0, 0, -10}), diffuse(glm::vec3(0)));
    const scene::Camera above{.position = {0, 4, 0.5f}, .target = {0, 0, 0}, .vertical_fov = 0.5f};
    constexpr rhi::Extent size{8, 8};
    const scene::GpuScene gpu = must(scene::GpuScene::create(device(), scene, true));
    const scene::GpuScene nothing = must(scene::GpuScene::create(device(), {}, true));
    auto gbuffer = must(gbuffer::GBuffer::create(device(), size, gbuffer::needs_of(gpu.view(), true)));
    auto volume = must(voxels::Volume::create(device(), {.resolution = 16}, {}));
    // The same cones at every pixel.
    const cones::Settings still{.turned = false};
    const cones::Needs needs{.environment = true, .sky = true};
    auto irradiance = must(cones::Irradiance::create(device(), still, needs, size));
    auto turned = must(cones::Irradiance::create(device(), {}, needs, size));
    auto sky = must(sky::Sky::create(device(), scene::earth(), quick()));

    for (const double zenith : {30.0, 75.0, 94.0}) {
        SCOPED_TRACE(zenith);
        set_sky(scene, {.direction_to_sun = sun_at(zenith)});
        rhi::Commands commands = device().begin();
        const gbuffer::View seen = gbuffer.record(commands, gpu.view(), gbuffer::camera_block(above, size));
        volume.voxelize(commands, nothing.view(), 0);
        volume.inject(commands, nullptr);
        const auto map_view = sky.record_map(commands, *scene.sky);
        irradiance.record(commands, seen, {.volume = volume.view(), .sky = map_view});
        turned.record(commands, seen, {.volume = volume.view(), .sky = map_view});
        must(device().wait(device().submit(std::move(commands))));
        const glm::dvec3 gathered(download(device(), irradiance.irradiance()).at(4, 4));
        glm::dvec3 by_turned(0);
        for (const glm::vec4& texel : download(device(), turned.irradiance()).texels)
            by_turned += glm::dvec3(texel) / double(size.width * size.height);

        constexpr uint32_t rows = 128;
        const scene::ImageF map = must(sky::download_map(device(), sky, rows));
        glm::dvec3 of_circles(0);
        for (const cones::Cone& cone : cones::distribute(still).cones) {
            // frame_about((0, 1, 0)) of shaders/common/frame.glsl has the columns x, -z and y.
            const glm::dvec3 axis(cone.direction.x, cone.direction.z, -cone.direction.y);
            glm::dvec3 sum(0);
            double weight = 0;
            for (uint32_t y = 0; y < rows; ++y) {
                for (uint32_t x = 0; x < 2 * rows; ++x) {
                    const double polar = pi * (y + 0.5) / rows, azimuth = pi * (x + 0.5) / rows;
                    const glm::dvec3 direction(std::sin(polar) * std::cos(azimuth), std::cos(polar),
                                               std::sin(polar) * std::sin(azimuth));
                    if (glm::dot(direction, axis) < std::cos(double(cone.half_angle))) continue;
                    sum += std::sin(polar) * pixel(map, x, y);
                    weight += std::sin(polar);
                }
            }
            of_circles += pi * double(cone.weight) * sum / weight;
        }
        expect_near(gathered, of_circles, 0.04);
        const glm::dvec3 truth = ask({.sun_zenith_deg = zenith, .quantity = Quantity::sky_irradiance});
        const glm::dvec3 of_frame = mean_of(render(scene, above, {Layer::irradiance}).layers[0].linear);
        const auto expect_within = [&](const char* name, glm::dvec3 value, double part) {
            const glm::dvec3 error = value / truth - 1.0;
            RecordProperty(fmt::format("sun_{}_{}", zenith, name),
                           fmt::format("{:+.3f} {:+.3f} {:+.3f}", error.r, error.g, error.b));
            for (int c = 0; c < 3; ++c) EXPECT_LT(std::abs(error[c]), part) << name << ", " << c;
        };
        expect_within("still", gathered, 0.2);
        expect_within("turned", by_turned, 0.05);
        expect_within("frame", of_frame, 0.15);
    }
}

TEST_P(SkyTest, ExtremesAreFiniteAndNotNegative) {
    Window window(device(), {12, 8});
    for (const double sun : {0.0, 90.0, 94.0, 108.0, 180.0}) {
        for (const auto& [altitude, zenith] : {std::pair(0.0, 90.0),
                                               {1e-6, 90.0},
                                               {0.0, 180.0},
                                               {0.0, 0.0},
                                               {60.0, 100.0},
                                               {1e4, 160.0},
                                               {1e4, 90.0}}) {
            const Picture seen =
                window.look({.direction_to_sun = sun_at(sun)}, camera_at(altitude, zenith, 20, 50));
            for (const glm::vec4& texel : seen.texels)
                for (int c = 0; c < 3; ++c)
                    ASSERT_TRUE(std::isfinite(texel[c]))
                        << texel[c] << ": sun " << sun << ", " << altitude << " km, view " << zenith;
        }
        scene::Scene scene = must(scene::make_builtin("sky"));
        set_sky(scene, {.direction_to_sun = sun_at(sun)});
        const auto rendered =
            render(scene, scene.cameras[0], {Layer::radiance, Layer::irradiance, Layer::specular}, {24, 16});
        for (const frame::LayerImage& layer : rendered.layers)
            for (const float value : layer.linear.values)
                ASSERT_TRUE(std::isfinite(value) && value >= 0) << value << ": sun " << sun;
    }
}

/// Frames as the camera climbs: each between its neighbours, within a small part of the frame.
TEST_P(SkyTest, ClimbsWithoutAStep) {
    Window window(device(), {2, 2});
    // Where no horizon comes past.
    for (const double view : {60.0, 88.0}) {
        std::vector<double> means;
        constexpr int frames = 101;
        for (int i = 0; i < frames; ++i) {
            const Picture seen = window.look({.direction_to_sun = sun_at(70)}, camera_at(i, view, 90, 1));
            double sum = 0;
            for (const glm::vec4& texel : seen.texels) sum += double(texel.g);
            means.push_back(sum / double(seen.texels.size()));
        }
        double worst = 0;
        for (size_t i = 2; i + 2 < frames; ++i) {
            const double smooth = (4 * (means[i - 1] + means[i + 1]) - means[i - 2] - means[i + 2]) / 6;
            worst = std::max(worst, std::abs(means[i] - smooth) / (means[i] + 0.01 * means[0]));
        }
        RecordProperty(fmt::format("view_{}", view), fmt::format("{:.4f}", worst));
        EXPECT_LT(worst, 0.02) << view;
    }
}

/// From eye height, a hundred rows within 0.1 degrees of the horizon. The sky is smooth down to it; on the ground the
/// distance grows the faster the nearer to it, and so does what the air adds.
TEST_P(SkyTest, HorizonHasNoSeam) {
    constexpr uint32_t rows = 100;
    Window window(device(), {2, rows});
    for (const double sun : {30.0, 88.0}) {
        SCOPED_TRACE(sun);
        const double dip = std::sqrt(2 * 0.0017 / 6360) / degree;
        const Picture seen =
            window.look({.direction_to_sun = sun_at(sun)}, camera_at(0.0017, 90 + dip, 120, 0.2));
        const auto green = [&](uint32_t y) { return double(seen.at(0, y).g); };
        for (uint32_t y = 1; y + 1 < rows; ++y) {
            const double before = green(y) - green(y - 1), after = green(y + 1) - green(y);
            // The edge lies between the rows 49 and 50, to the direction's rounding.
            if (y + 1 < rows / 2 - 1) {
                EXPECT_GT(after, before - 1e-5 * green(y)) << y;
            } else if (y - 1 > rows / 2) {
                EXPECT_NEAR(after, before, 1e-3 * green(y)) << y;
            }
        }
        EXPECT_GT(green(rows / 2 + 1), 2 * green(rows / 2 - 2));
    }
}

TEST_P(SkyTest, RefusesMapsOfOddSizes) {
    for (const uint32_t side : {0u, 16u, 100u, 4096u})
        EXPECT_FALSE(sky::Sky::create(device(), scene::earth(), {.map_side = side}));
}

}  // namespace
}  // namespace lumo
