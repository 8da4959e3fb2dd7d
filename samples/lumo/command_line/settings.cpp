#include "samples/lumo/command_line/settings.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <limits>

#include "samples/lumo/command_line/arguments.hpp"
#include "samples/lumo/values.hpp"
#include "scene/builtin/builtin.hpp"
#include "scene/file.hpp"
#include "scene/printable.hpp"

namespace lumo::program {
namespace {

using Json = nlohmann::ordered_json;

constexpr uint64_t largest_config = uint64_t(1) << 20;  // bytes
constexpr uint32_t most_frames = 1'000'000;

}  // namespace

SettingOptions add_technique_settings(CLI::App& app, Options& options) {
    SettingOptions all;
    const auto setting = [&](const std::string& name, const std::string& type, const std::string& standard,
                             const std::string& help, const auto& parse) {
        all.emplace_back(name.substr(2), add(app, name, type, standard, help, parse));
    };
    frame::Settings& frame = options.frame;

    setting("--gi", "on|off", "on", "indirect light",
            one_of<bool>(&frame.gi, {{"on", true}, {"off", false}}));
    setting("--storage", "vt|svo", "vt", "of the voxels: a volume texture, or a sparse octree",
            one_of<voxels::Storage>(&frame.voxels.storage,
                                    {{"vt", voxels::Storage::dense}, {"svo", voxels::Storage::octree}}));
    setting("--voxels", "N", fmt::to_string(frame.voxels.resolution), "a side: a power of two, 16 to 1024",
            into(frame.voxels.resolution, parse_voxels));
    setting("--grid-size", "METRES|scene", "scene",
            "a side of the voxels' grid, which then follows the camera in whole voxels; what lies outside is "
            "left out, and cones that leave it see the environment; scene: it holds the scene",
            [&](const std::string& text) -> Result<void> {
                frame.voxels.grid_size.reset();
                if (text == "scene") return {};
                return parse_distance(text).map([&](float metres) { frame.voxels.grid_size = metres; });
            });
    setting("--mips", "iso|ani", "ani", "of the voxels: isotropic, or anisotropic in six directions",
            one_of<voxels::MipKind>(&frame.voxels.mips, {{"iso", voxels::MipKind::isotropic},
                                                         {"ani", voxels::MipKind::anisotropic}}));
    using Range = std::optional<voxels::Range>;
    std::vector<std::pair<std::string, Range>> ranges{{"auto", std::nullopt}};
    for (const voxels::Range range : voxels::all_ranges) ranges.emplace_back(to_string(range), range);
    setting("--range", "NAME", "auto",
            "of the voxels' light: ldr or average, 8 bits; mutex, rgbe or fixed, half floats; auto: ldr, or "
            "fixed "
            "where the scene needs more",
            one_of<Range>(&frame.range, ranges));
    setting("--voxelizer", "raster|compute", "compute", "who finds the voxels that a triangle meets",
            one_of<voxels::VoxelizerKind>(
                &frame.voxels.voxelizer,
                {{"raster", voxels::VoxelizerKind::raster}, {"compute", voxels::VoxelizerKind::compute}}));
    setting("--cones", "N", fmt::to_string(frame.cones.count),
            fmt::format("a pixel, 1 to {}", cones::max_cones), [&](const std::string& text) -> Result<void> {
                return parse_integer(text, 1, cones::max_cones).map([&](uint32_t count) {
                    frame.cones.count = int(count);
                });
            });
    setting("--apertures", "uniform|nonuniform", "uniform",
            "of the cones: all the same, or as wide as each ring has room for",
            one_of<cones::Apertures>(&frame.cones.apertures, {{"uniform", cones::Apertures::uniform},
                                                              {"nonuniform", cones::Apertures::nonuniform}}));
    setting(
        "--rotate-cones", "on|off", "on",
        "each of 4 x 4 pixels has narrower cones of its own, and takes the mean over those of its surface",
        one_of<bool>(&frame.cones.turned, {{"on", true}, {"off", false}}));
    setting("--gather", "cones|rays|floor", "cones",
            "what gathers the diffuse light of visible surfaces; rays: through the finest voxels; floor: "
            "many of them, "
            "for each pixel by itself, all emission too, to measure what cones and rays lose",
            one_of<frame::Gatherer>(&frame.gatherer, {{"cones", frame::Gatherer::cones},
                                                      {"rays", frame::Gatherer::rays},
                                                      {"floor", frame::Gatherer::floor}}));
    setting(
        "--rays", "N|auto", "auto",
        fmt::format("a pixel, of --gather rays and floor, 1 to {}; auto: 16, or 256 of the floor",
                    cones::max_rays),
        [&](const std::string& text) -> Result<void> {
            frame.rays.reset();
            if (text == "auto") return {};
            return parse_integer(text, 1, cones::max_rays).map([&](uint32_t count) { frame.rays = count; });
        });
    setting("--ao-radius", "METRES|auto", "auto",
            "of the layer ao: what is as far occludes by half, 1 / (1 + distance / radius); auto: a tenth of "
            "the voxels' grid",
            [&](const std::string& text) -> Result<void> {
                frame.ao_radius.reset();
                if (text == "auto") return {};
                return parse_distance(text).map([&](float metres) { frame.ao_radius = metres; });
            });
    setting("--bounces", "N", fmt::to_string(frame.bounces),
            "light is reflected at most N times before the visible surface reflects it",
            [&](const std::string& text) -> Result<void> {
                return parse_integer(text, 1, std::numeric_limits<uint32_t>::max()).map([&](uint32_t count) {
                    frame.bounces = count;
                });
            });
    setting("--plan", "auto|full", "auto", "full: nothing is left out of the frame",
            one_of<frame::PlanMode>(&frame.plan,
                                    {{"auto", frame::PlanMode::automatic}, {"full", frame::PlanMode::full}}));
    return all;
}

SettingOptions add_scene_settings(CLI::App& app, Options& options) {
    SettingOptions all;
    const auto setting = [&](const std::string& name, const std::string& type, const std::string& standard,
                             const std::string& help, const auto& parse) {
        CLI::Option* option = add(app, name, type, standard, help, parse);
        all.emplace_back(CLI::detail::to_lower(name.starts_with("--") ? name.substr(2) : name), option);
    };
    frame::Settings& frame = options.frame;

    setting("SCENE", "", options.scene,
            fmt::format("a .gltf or .glb file, or {}", fmt::join(scene::builtin_names(), ", ")),
            [&](const std::string& text) -> Result<void> {
                options.scene = text;
                return {};
            });
    setting("--sun", "DX,DY,DZ:R,G,B", "",
            "direction toward the sun and its irradiance on a plane facing it, W/m², or none; replaces the "
            "scene's directional lights; a scene without any light gets one, if not given",
            [&](const std::string& text) -> Result<void> {
                return parse_sun(text).map([&](const Sun& sun) { options.sun = sun; });
            });
    std::ranges::copy(add_technique_settings(app, options), std::back_inserter(all));
    setting("--sky", "none|on", "none",
            "on: an atmosphere around the scene, in place of its own environment, and its sun in the "
            "direction of "
            "--sun or of the scene's first directional light, as bright as the air lets it; the scene sky "
            "has one",
            one_of<bool>(&options.sky, {{"none", false}, {"on", true}}));
    setting("--atmosphere", "FILE", "", "the sky's air, sun and ground as JSON; Earth's, if not given",
            [&](const std::string& text) -> Result<void> {
                options.atmosphere = text;
                return {};
            });
    setting("--preset", "fast|default|precise", "default", "of the sky's tables: error against time",
            [&](const std::string& text) -> Result<void> {
                return atmosphere::parse_preset(text).map(
                    [&](atmosphere::Preset preset) { frame.sky.tables = atmosphere::settings_of(preset); });
            });
    setting("--altitude", "KM", "", "of the scene's origin above the planet's ground: 0, if not given",
            [&](const std::string& text) -> Result<void> {
                return parse_altitude(text).map([&](double km) { options.altitude_km = km; });
            });
    setting("--materials", "pbr|diffuse", "pbr",
            "diffuse: Lambertian with the base colour, without normal maps",
            one_of<bool>(&frame.diffuse_materials, {{"pbr", false}, {"diffuse", true}}));
    setting("--layer", "NAMES", "final",
            "final, radiance, direct, indirect, irradiance, specular, ao, emission, albedo, normal, depth, "
            "voxels; several by "
            "commas into one EXR, where final is the radiance without a layer's name; specular: of opaque "
            "surfaces, as blended ones have no specular cones",
            into(frame.layers, parse_layers));
    all.emplace_back("photometric", add_flag(app, "--photometric", options.photometric,
                                             "the file's lights are lux, candela and nit: divide by 683"));
    return all;
}

SettingOptions add_device_settings(CLI::App& app, Options& options, const std::string& apis) {
    SettingOptions all;
    all.emplace_back("api", add(app, "--api", "vulkan|gl|both", "", apis,
                                one_of<ApiChoice>(&options.api, {{"vulkan", ApiChoice::vulkan},
                                                                 {"gl", ApiChoice::gl},
                                                                 {"both", ApiChoice::both}})));
    all.emplace_back("device", add(app, "--device", "NAME", "", "a part of the device's name",
                                   [&](const std::string& text) -> Result<void> {
                                       options.device = text;
                                       return {};
                                   }));
    return all;
}

SettingOptions add_view_settings(CLI::App& app, Options& options, const std::string& apis) {
    SettingOptions all = add_device_settings(app, options, apis + ", if not given");
    const auto setting = [&](const std::string& name, const std::string& type, const std::string& standard,
                             const std::string& help, const auto& parse) {
        all.emplace_back(name.substr(2), add(app, name, type, standard, help, parse));
    };
    frame::Settings& frame = options.frame;

    setting("--size", "WxH", fmt::format("{}x{}", frame.size.width, frame.size.height), "in pixels",
            into(frame.size, parse_size));
    setting(
        "--camera", "PX,PY,PZ:TX,TY,TZ:FOV", "",
        "position, target and vertical angle in degrees, or the name or index of the scene's; up is +Y, or "
        "-Z when looking straight along Y",
        into(options.camera, parse_camera));
    return all;
}

CLI::Option* add_spp(CLI::App& app, Options& options) {
    return add(
        app, "--spp", "N", fmt::to_string(options.spp), "samples a pixel of the path tracer, 2 and up",
        [&](const std::string& text) -> Result<void> {
            return parse_integer(text, 2, std::numeric_limits<uint32_t>::max()).map([&](uint32_t count) {
                options.spp = count;
            });
        });
}

CLI::Option* add_runs(CLI::App& app, Options& options, const std::string& help) {
    return add(app, "--runs", "N", "", help, [&](const std::string& text) -> Result<void> {
        return parse_integer(text, 1, 1000).map([&](uint32_t count) { options.runs = count; });
    });
}

SettingOptions add_picture_settings(CLI::App& app, Options& options) {
    SettingOptions all = add_view_settings(app, options, "the first that works");
    const auto setting = [&](const std::string& name, const std::string& type, const std::string& standard,
                             const std::string& help, const auto& parse) {
        all.emplace_back(name.substr(2), add(app, name, type, standard, help, parse));
    };
    frame::Settings& frame = options.frame;

    setting("--exposure", "STOPS|auto", "auto",
            fmt::format("of display-referred pictures; auto: 0, or under a sky {}, and more the darker it is",
                        frame::daylight_exposure),
            [&](const std::string& text) -> Result<void> {
                frame.exposure.reset();
                if (text == "auto") return {};
                return parse_exposure(text).map([&](float stops) { frame.exposure = stops; });
            });
    std::vector<std::pair<std::string, post::Tonemap>> curves;
    for (int i = 0; i < post::tonemap_count; ++i)
        curves.emplace_back(to_string(post::Tonemap(i)), post::Tonemap(i));
    setting("--tonemap", "none|reinhard|hable|aces|agx", std::string(to_string(frame.post.tonemap)),
            "of display-referred pictures", one_of<post::Tonemap>(&frame.post.tonemap, curves));

    all.emplace_back("reference",
                     add_flag(app, "--reference", options.reference,
                              "the path tracer on the CPU instead of a GPU: .exr, at pixel centres"));
    all.emplace_back("spp", add_spp(app, options));

    Animation& animation = options.animation;
    setting(
        "--frames", "N", fmt::to_string(animation.count), "an animation, in files NAME.0001.EXT",
        [&](const std::string& text) -> Result<void> {
            return parse_integer(text, 1, most_frames).map([&](uint32_t count) { animation.count = count; });
        });
    setting("--orbit", "DEGREES", fmt::format("{}", animation.orbit),
            "the animation turns the camera about its target", [&](const std::string& text) -> Result<void> {
                return parse_number(text).map([&](double degrees) { animation.orbit = float(degrees); });
            });
    setting("--sun-to", "DX,DY,DZ:R,G,B", "", "the animation moves the sun there",
            [&](const std::string& text) -> Result<void> {
                return parse_sun(text).map([&](const Sun& sun) { animation.sun_to = sun; });
            });
    return all;
}

std::string as_argument(const Json& value) {
    return value.is_string() ? value.get<std::string>() : value.dump();
}

Result<void> give(CLI::Option& option, const std::string& value) {
    try {
        option.add_result(value);
        option.run_callback();
    } catch (const CLI::Error& error) {
        return fail(ErrorKind::invalid_argument, scene::printable(value),
                    scene::printable(error.what(), 1000));
    }
    return {};
}

std::string names_of(const SettingOptions& settings) {
    std::vector<std::string> names;
    for (const auto& [name, option] : settings) names.push_back(name);
    return available(names);
}

Result<void> read_config(const std::filesystem::path& file, const SettingOptions& settings) {
    const std::string name = scene::printable(file.string());
    const auto bytes = scene::read_file(file, largest_config);
    if (!bytes) return tl::unexpected(bytes.error());
    Json config = Json::parse(reinterpret_cast<const char*>(bytes->data()),
                              reinterpret_cast<const char*>(bytes->data() + bytes->size()), nullptr, false);
    if (config.is_object() && config.contains("settings")) config = Json(config["settings"]);
    if (!config.is_object())
        return fail(ErrorKind::invalid_file, name, "is not a JSON object", "give a file that --stats wrote");

    for (const auto& [key, value] : config.items()) {
        const auto setting = std::ranges::find(settings, key, &SettingOptions::value_type::first);
        if (setting == settings.end())
            return fail(ErrorKind::invalid_file, name, fmt::format("no setting '{}'", scene::printable(key)),
                        names_of(settings));
        CLI::Option* option = setting->second;
        if (option->count() > 0) continue;
        if (const Result<void> given = give(*option, as_argument(value)); !given)
            return fail(ErrorKind::invalid_file, name, given.error().message);
    }
    return {};
}

Json collect(const SettingOptions& settings) {
    Json all = Json::object();
    for (const auto& [name, option] : settings) {
        const std::string text = option->count() > 0 ? option->results().back() : option->get_default_str();
        if (option->get_expected_max() == 0) {
            all[name] = text == "true";
        } else if (!text.empty()) {
            const Json number = Json::parse(text, nullptr, false);
            all[name] = number.is_number() ? number : Json(text);
        }
    }
    return all;
}

}  // namespace lumo::program
