#include "samples/lumo/options.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include "samples/lumo/bench/bench.hpp"
#include "samples/lumo/values.hpp"
#include "scene/builtin/builtin.hpp"
#include "scene/file.hpp"
#include "scene/printable.hpp"

namespace lumo::program {
namespace {

using Json = nlohmann::ordered_json;

constexpr uint64_t largest_config = uint64_t(1) << 20;  // bytes
constexpr uint32_t most_frames = 1'000'000;

using NamedCommand = std::pair<std::string_view, Command>;
constexpr std::array<NamedCommand, 8> commands{{{"render", Command::render},
                                                {"check", Command::check},
                                                {"diff", Command::diff},
                                                {"devices", Command::devices},
                                                {"bench", Command::bench},
                                                {"probe", Command::probe},
                                                {"report", Command::report},
                                                {"tune", Command::tune}}};

std::string available(auto&& names) { return fmt::format("available: {}", fmt::join(names, ", ")); }

constexpr int name_column = 34, help_columns = 76;

/// Help in lines of at most help_columns.
std::string wrapped(const std::string& help) {
    std::string text;
    size_t line = 0;
    for (size_t begin = 0; begin < help.size();) {
        const size_t end = std::min(help.find(' ', begin), help.size());
        const size_t word = end - begin;
        if (line > 0 && line + 1 + word > help_columns) {
            text += '\n';
            line = 0;
        }
        if (line > 0) text += ' ';
        text += help.substr(begin, word);
        line += word + 1;
        begin = end + 1;
    }
    return text;
}

/// An option whose value is text for `parse`, which puts it into its place.
CLI::Option* add(CLI::App& app, const std::string& name, const std::string& type, const std::string& help,
                 const std::function<Result<void>(const std::string&)>& parse) {
    const auto read = [name, parse](const std::string& text) {
        if (const Result<void> done = parse(text); !done)
            throw CLI::ValidationError(name, scene::printable(to_string(done.error()), 1000));
    };
    return app.add_option_function<std::string>(name, read, wrapped(help))->option_text(type);
}

/// The same with a default, which help shows behind the type.
CLI::Option* add(CLI::App& app, const std::string& name, const std::string& type, const std::string& standard,
                 const std::string& help, const std::function<Result<void>(const std::string&)>& parse) {
    CLI::Option* option = add(app, name, type, help, parse)->default_str(standard);
    if (!standard.empty())
        option->option_text(fmt::format("{}{}({})", type, type.empty() ? "" : " ", standard));
    return option;
}

CLI::Option* add_file(CLI::App& app, const std::string& name, std::filesystem::path& place,
                      const std::string& help) {
    return app.add_option(name, place, wrapped(help))->option_text("FILE");
}

CLI::Option* add_flag(CLI::App& app, const std::string& name, bool& place, const std::string& help) {
    return app.add_flag(name, place, wrapped(help));
}

/// How to turn text into a value and where to put it.
template <class T>
std::function<Result<void>(const std::string&)> into(T& place, Result<T> (*parse)(std::string_view)) {
    return [&place, parse](const std::string& text) -> Result<void> {
        return parse(text).map([&](T value) { place = std::move(value); });
    };
}

/// The same for a value out of a list of names; `place` is null where one name is all there is.
template <class T>
std::function<Result<void>(const std::string&)> one_of(T* place,
                                                       std::vector<std::pair<std::string, T>> names) {
    return [place, names = std::move(names)](const std::string& text) -> Result<void> {
        const auto found = std::ranges::find(names, text, &std::pair<std::string, T>::first);
        if (found == names.end()) {
            std::vector<std::string> known;
            for (const auto& [name, value] : names) known.push_back(name);
            return fail(ErrorKind::invalid_argument, fmt::format("'{}'", text), "there is no such value",
                        available(known));
        }
        if (place) *place = found->second;
        return {};
    };
}

std::function<Result<void>(const std::string&)> only(std::string name) {
    return one_of<int>(nullptr, {{std::move(name), 0}});
}

/// Options that --stats writes and --config reads, by their names without dashes.
using SettingOptions = std::vector<std::pair<std::string, CLI::Option*>>;

/// How a frame is made: what changes its time and its error, and not what it shows.
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
    setting("--gather", "cones|rays", "cones",
            "what gathers the diffuse light of visible surfaces; rays: many through the finest voxels, to "
            "measure "
            "what cones lose (the floor of their error)",
            one_of<frame::Gatherer>(&frame.gatherer,
                                    {{"cones", frame::Gatherer::cones}, {"rays", frame::Gatherer::rays}}));
    setting(
        "--rays", "N", fmt::to_string(frame.rays),
        fmt::format("a pixel, of --gather rays, 1 to {}", cones::max_rays),
        [&](const std::string& text) -> Result<void> {
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

/// What a frame of a scene depends on, whatever draws it.
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

/// What draws, and what it sees of the scene. `apis`: those that are used where none is given.
SettingOptions add_view_settings(CLI::App& app, Options& options, const std::string& apis) {
    SettingOptions all;
    const auto setting = [&](const std::string& name, const std::string& type, const std::string& standard,
                             const std::string& help, const auto& parse) {
        all.emplace_back(name.substr(2), add(app, name, type, standard, help, parse));
    };
    frame::Settings& frame = options.frame;

    setting(
        "--api", "vulkan|gl|both", "", apis + ", if not given",
        one_of<ApiChoice>(&options.api,
                          {{"vulkan", ApiChoice::vulkan}, {"gl", ApiChoice::gl}, {"both", ApiChoice::both}}));
    setting("--device", "NAME", "", "a part of the device's name",
            [&](const std::string& text) -> Result<void> {
                options.device = text;
                return {};
            });
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

void add_validation(CLI::App& app, Options& options) {
    add_flag(app, "--validation", options.validation,
             "the validation layers, or a debug context; what they find fails the run")
        ->envname("LUMO_VALIDATION");
}

/// What a picture depends on beside.
SettingOptions add_picture_settings(CLI::App& app, Options& options) {
    SettingOptions all = add_view_settings(app, options, "the first that works");
    const auto setting = [&](const std::string& name, const std::string& type, const std::string& standard,
                             const std::string& help, const auto& parse) {
        all.emplace_back(name.substr(2), add(app, name, type, standard, help, parse));
    };
    frame::Settings& frame = options.frame;

    setting("--exposure", "STOPS|auto", "auto",
            fmt::format("of display-referred pictures; auto: 0, or {} under a sky", frame::daylight_exposure),
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

/// Gives an option a value as the command line would. Errors: invalid_argument.
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

/// Gives options the values of a file where the command line has none.
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

/// The value of each setting as its JSON form: numbers, true and false, or text. A setting that has neither a
/// value nor a default is left out.
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

Refusal refusal(const std::string& prefix, const std::string& text) {
    return {.exit_code = exit_failed, .text = prefix + ": " + text};
}

std::string option_names(const CLI::App& app) {
    std::vector<std::string> names;
    for (const CLI::Option* option : app.get_options()) {
        if (!option->get_positional()) names.push_back(option->get_name());
    }
    return available(names);
}

SettingOptions add_render(CLI::App& app, Options& options, std::filesystem::path& config) {
    SettingOptions settings = add_scene_settings(app, options);
    std::ranges::copy(add_picture_settings(app, options), std::back_inserter(settings));
    add(app, "--shard", "I/N", "this part of the animation alone",
        [&](const std::string& text) -> Result<void> {
            return parse_shard(text).map([&](Shard shard) {
                options.animation.shard = shard.index;
                options.animation.shards = shard.count;
            });
        });
    add_file(app, "-o", options.output,
             "the picture: .png (display-referred) or .exr (linear radiance, or layers); with --api both "
             "NAME.gl.EXT, NAME.vulkan.EXT and NAME.diff.EXT (in an .exr: |gl - vulkan|); if not given, "
             "SCENE.png, or SCENE.exr for layers");
    add_file(app, "--config", config,
             "settings from a JSON file, as --stats writes them; the command line's own come first");
    add_file(app, "--stats", options.stats,
             "writes device, settings, times, memory and what was left out as JSON; with --api both "
             "NAME.gl.EXT and NAME.vulkan.EXT");
    add_file(
        app, "--capture", options.capture,
        "what the device is given for the first frame, as a .rdc file for RenderDoc, under which lumo has to "
        "run: renderdoccmd capture -w lumo render ...");
    add_flag(app, "--explain", options.explain, "prints what the frame needs and leaves out, and why");
    add_flag(app, "--quiet", options.quiet, "no progress, nothing but warnings and errors");
    add_validation(app, options);
    app.footer(
        "Exit code 1 if, with --api both, the pictures differ by more than they may.\n\n"
        "Examples:\n"
        "  lumo render                                     the atrium, to atrium.png\n"
        "  lumo render Sponza.gltf --api both --size 480x270 -o sponza.png\n"
        "  lumo render cornell --layer irradiance,depth -o cornell.exr\n"
        "  lumo render cornell --reference --spp 1024 --layer irradiance -o truth.exr\n"
        "  lumo render atrium --sun 0.3,1,0.2:12,11,10 --exposure -1 --tonemap agx -o noon.png\n"
        "  lumo render cornell --stats run.json && lumo render --config run.json -o again.png\n"
        "  lumo render atrium --frames 48 --orbit 360 --shard 2/8 -o turn.png\n"
        "  lumo render atrium --sky on --sun 1,0.3,0.2:1,1,1 -o evening.png");
    return settings;
}

SettingOptions add_check(CLI::App& app, Options& options) {
    SettingOptions settings = add_scene_settings(app, options);
    add_flag(app, "--json", options.json, "machine-readable output");
    app.footer(
        "Examples:\n"
        "  lumo check Sponza.gltf\n"
        "  lumo check cornell --gi off --json");
    return settings;
}

SettingOptions add_report(CLI::App& app, Options& options) {
    SettingOptions settings = add_scene_settings(app, options);
    std::ranges::copy(add_view_settings(app, options, "each that works"), std::back_inserter(settings));
    const auto add_list = [&](const char* name, const char* type, std::vector<std::string>& place,
                              const std::string& help) {
        app.add_option(name, place, wrapped(help))->option_text(type)->allow_extra_args(false);
    };
    add_list("--vary", "NAME=V1,V2,... ...", options.vary,
             "values of an option, as voxels=64,128; given several times, every combination is measured; if "
             "not given, voxels, cones, mips and rotate-cones");
    add_list("--also", "NAME=V,... ...", options.also, "one configuration more, as voxels=256,cones=18");
    settings.emplace_back("spp", add_spp(app, options));
    settings.emplace_back("runs", add_runs(app, options,
                                           "frames by which a configuration is timed, at most: fewer where "
                                           "their median is stable; if not given, 15"));
    add_file(app, "-o", options.output,
             "the folder for report.json, report.csv, plots and index.html; what it holds of an interrupted "
             "report is not measured again; if not given, SCENE-report")
        ->option_text("FOLDER");
    add_flag(app, "--quiet", options.quiet, "no progress, nothing but warnings and errors");
    add_validation(app, options);
    app.footer(
        "If not given, --size is 320x180 and --layer is irradiance. Path-traced pictures are kept in "
        "$XDG_CACHE_HOME/lumo/reference.\n\n"
        "Examples:\n"
        "  lumo report cornell\n"
        "  lumo report Sponza.gltf --api both --vary voxels=128,256 --vary cones=6,9 -o sponza\n"
        "  lumo report atrium --also bounces=4 --spp 1024 --size 160x90");
    return settings;
}

SettingOptions add_tune(CLI::App& app, Options& options) {
    SettingOptions settings = add_scene_settings(app, options);
    std::ranges::copy(add_view_settings(app, options, "the first that works"), std::back_inserter(settings));
    add(app, "--max-error", "E", "the cheapest configuration with at most this relative RMSE: 0.15, or 15%",
        [&](const std::string& text) -> Result<void> {
            return parse_ratio(text).map([&](double ratio) { options.max_error = ratio; });
        });
    add(app, "--max-ms", "T",
        "the most accurate configuration of which a frame takes at most so long on the GPU; with --max-error "
        "the cheapest one within both",
        [&](const std::string& text) -> Result<void> {
            return parse_positive(text).map([&](double milliseconds) { options.max_ms = milliseconds; });
        });
    settings.emplace_back("spp", add_spp(app, options));
    settings.emplace_back("runs", add_runs(app, options,
                                           "frames by which a configuration is timed, at most: fewer where "
                                           "their median is stable; if not given, 9"));
    add_flag(app, "--json", options.json, "machine-readable output");
    add_flag(app, "--quiet", options.quiet, "no progress, nothing but warnings and errors");
    add_validation(app, options);
    app.footer(
        "What is not given is free: voxels, mips, storage, range, voxelizer, cones, apertures, rotate-cones "
        "and bounces.\n"
        "The error is that of --layer (irradiance, if not given) against the path tracer, at as many bounces "
        "as are\ngiven, or else at all. If not given, --size is 320x180.\n"
        "Exit code 1 if no configuration was found that keeps the bounds.\n\n"
        "Examples:\n"
        "  lumo tune cornell --max-error 0.2\n"
        "  lumo tune Sponza.gltf --max-ms 8 --api vulkan --storage vt\n"
        "  lumo tune atrium --max-error 25% --bounces 1 --json");
    return settings;
}

void add_diff(CLI::App& app, Options& options) {
    add_file(app, "A", options.first, "the reference: .png, .jpg, .hdr or .exr")->required();
    add_file(app, "B", options.second, "a picture of the same kind")->required();
    add_file(app, "-o", options.output, "the difference: .png in false colours, .exr as |A - B|");
    add(app, "--rule", "mesa|hardware", "mesa", "how far two APIs may be apart on software drivers, or else",
        one_of<ParityChoice>(&options.parity,
                             {{"mesa", ParityChoice::mesa}, {"hardware", ParityChoice::hardware}}));
    add_flag(app, "--json", options.json, "machine-readable output");
    app.footer(
        "Exit code 1 if the pictures differ by more than the rule allows.\n\n"
        "Examples:\n"
        "  lumo diff atrium.gl.png atrium.vulkan.png -o difference.png\n"
        "  lumo diff before.exr after.exr --rule hardware --json");
}

void add_devices(CLI::App& app, Options& options) {
    add_flag(app, "--json", options.json, "machine-readable output");
    app.footer(
        "Examples:\n"
        "  lumo devices\n"
        "  lumo devices --json");
}

SettingOptions add_bench(CLI::App& app, Options& options) {
    std::vector<std::pair<std::string, std::string>> names;
    std::string known;
    for (const Benchmark& benchmark : benchmarks()) {
        names.emplace_back(benchmark.name, benchmark.name);
        known += fmt::format("{}{}: {}", known.empty() ? "" : "\n", benchmark.name,
                             wrapped(std::string(benchmark.does)));
    }
    add(app, "NAME", "", "", one_of<std::string>(&options.benchmark, names))->description(known)->required();
    SettingOptions settings = add_scene_settings(app, options);
    std::ranges::copy(add_view_settings(app, options, "each that works"), std::back_inserter(settings));
    settings.emplace_back(
        "runs", add_runs(app, options,
                         "figures are medians of so many: if not given 5, of voxels 100, of atmosphere 1"));
    add_file(app, "--truth", options.truth,
             "of atmosphere: a CSV file that scripts/atmosphere-truth wrote, to measure errors by");
    add_flag(app, "--json", options.json, "machine-readable output");
    add_flag(app, "--quiet", options.quiet, "no progress, nothing but warnings and errors");
    app.footer(
        "Examples:\n"
        "  lumo bench voxels Sponza.gltf --runs 3 --voxels 128 --size 480x270\n"
        "  lumo bench memory Sponza.gltf\n"
        "  lumo bench atmosphere --truth tests/data/atmosphere/earth.csv --size 320x180\n"
        "  lumo bench rhi\n"
        "  lumo bench rhi --api vulkan --runs 9 --json");
    return settings;
}

void add_probe(CLI::App& app, Options& options) {
    Probe& probe = options.probe;
    add(app, "NAME", "", "", only("sky"))
        ->description("sky: light and transmittance of an atmosphere, a row for each question")
        ->required();
    add_file(app, "--in", probe.input,
             "CSV with the columns quantity, camera_alt_km, view_zenith_deg, sun_zenith_deg, rel_azimuth_deg "
             "and distance_km; further ones are kept")
        ->required();
    add_file(
        app, "--out", options.output,
        "the same with the columns value_0, value_1 ..., one for each wavelength, in W/m²/sr/nm, W/m²/nm "
        "or 1; by --reference also error_0 ..., the standard errors of what is sampled")
        ->required();
    add_file(app, "--atmosphere", options.atmosphere, "JSON; Earth, if not given");
    add(app, "--orders", "N|all", "all",
        "of scattering and reflection by the ground, 1 to 1000: of radiance, inscatter and sky_irradiance",
        into(probe.truth.last_order, parse_orders));
    add(app, "--preset", "fast|default|precise", "default", "of tables and quadratures: error against time",
        [&](const std::string& text) -> Result<void> {
            return atmosphere::parse_preset(text).map(
                [&](atmosphere::Preset preset) { probe.settings = atmosphere::settings_of(preset); });
        });
    add(app, "--api", "vulkan|gl|both", "",
        "the first that works, if not given; both: into NAME.gl.EXT and NAME.vulkan.EXT",
        one_of<ApiChoice>(&options.api,
                          {{"vulkan", ApiChoice::vulkan}, {"gl", ApiChoice::gl}, {"both", ApiChoice::both}}));
    add(app, "--device", "NAME", "", "a part of the device's name",
        [&](const std::string& text) -> Result<void> {
            options.device = text;
            return {};
        });
    add_flag(app, "--validation", options.validation,
             "the validation layers, or a debug context; what they find fails the run")
        ->envname("LUMO_VALIDATION");
    add_flag(app, "--reference", options.reference, "on the CPU in double precision instead of a GPU");
    add(app, "--samples", "N", fmt::to_string(probe.truth.samples), "of the reference: at most, a row",
        [&](const std::string& text) -> Result<void> {
            return parse_integer(text, 1, 1'000'000'000).map([&](uint32_t count) {
                probe.truth.samples = count;
            });
        });
    add(app, "--max-error", "PART", fmt::format("{}", probe.truth.relative_error),
        "of the reference: the standard error, relative to the value, that ends a row's sampling",
        into(probe.truth.relative_error, parse_part));
    add_flag(app, "--quiet", options.quiet, "no progress, nothing but warnings and errors");
    app.footer(
        "Quantities: transmittance_to_space, transmittance_segment (over distance_km), radiance, "
        "radiance_order1,\n"
        "inscatter (over distance_km), sky_irradiance and sun_irradiance (on a horizontal plane). View "
        "zenith "
        "is at\n"
        "the camera from the local vertical, azimuth 0 is toward the sun. A row's cells for what its "
        "quantity "
        "does\n"
        "not depend on may be empty. Exit code 1 if, with --api both, the answers differ by more than they "
        "may.\n\n"
        "Examples:\n"
        "  lumo probe sky --in rows.csv --out answers.csv\n"
        "  lumo probe sky --in rows.csv --out answers.csv --api both --preset precise\n"
        "  lumo probe sky --in rows.csv --out mars.csv --atmosphere mars.json --orders 4 --reference\n"
        "  lumo probe sky --in rows.csv --out exact.csv --reference --max-error 0.0005 --samples 20000000");
}

}  // namespace

Result<Options> with_settings(const Options& options, const std::vector<SettingValue>& values) {
    Options changed = options;
    CLI::App app;
    const SettingOptions settings = add_technique_settings(app, changed);
    for (const auto& [name, value] : values) {
        const auto setting = std::ranges::find(settings, name, &SettingOptions::value_type::first);
        if (setting == settings.end())
            return fail(ErrorKind::invalid_argument, fmt::format("'{}'", scene::printable(name)),
                        "is no setting that can be varied", names_of(settings));
        if (Result<void> given = give(*setting->second, value); !given) return tl::unexpected(given.error());
        changed.settings.update(collect({*setting}));
        changed.given.insert(name);
    }
    return changed;
}

Json technique_settings(const Options& options) {
    Options unused;
    CLI::App app;
    Json all = Json::object();
    for (const auto& [name, option] : add_technique_settings(app, unused))
        if (options.settings.contains(name)) all[name] = options.settings[name];
    return all;
}

tl::expected<Options, Refusal> parse_options(int argc, const char* const* argv) {
    Options options;
    CLI::App app{"lumo: real-time global illumination on OpenGL and Vulkan", "lumo"};
    app.get_formatter()->column_width(name_column);
    app.require_subcommand(0, 1);
    bool version = false;
    add_flag(app, "--version", version, "the build, and the drivers");
    app.footer(
        "Each subcommand has a --help with examples.\n\n"
        "Exit codes: 0 all was done; 1 two pictures differ by more than they may; 2 something failed.");

    std::filesystem::path config;
    const SettingOptions render_settings = add_render(
        *app.add_subcommand("render", "Renders a scene to a picture, without a window."), options, config);
    const SettingOptions check_settings = add_check(
        *app.add_subcommand("check", "Says what a scene holds, and what a frame of it needs and leaves out."),
        options);
    add_diff(*app.add_subcommand("diff", "Compares two pictures."), options);
    add_devices(*app.add_subcommand("devices", "Lists the devices that each API finds."), options);

    const SettingOptions bench_settings =
        add_bench(*app.add_subcommand("bench", "Measures what is to be fast."), options);

    add_probe(*app.add_subcommand("probe", "Answers with numbers instead of pictures."), options);

    const SettingOptions report_settings = add_report(
        *app.add_subcommand("report", "Measures error against run time, by configuration."), options);
    const SettingOptions tune_settings = add_tune(
        *app.add_subcommand("tune", "Finds the configuration that keeps a bound on error or time."), options);

    const auto is_command = [](std::string_view name) {
        return std::ranges::find(commands, name, &NamedCommand::first) != commands.end();
    };
    if (argc > 1 && argv[1][0] != '-' && !is_command(argv[1])) {
        std::vector<std::string_view> names;
        for (const NamedCommand& command : commands) names.push_back(command.first);
        return tl::unexpected(refusal("lumo", fmt::format("there is no subcommand '{}' ({})",
                                                          scene::printable(argv[1]), available(names))));
    }

    const auto chosen = [&]() -> const CLI::App& {
        return app.get_subcommands().empty() ? app : *app.get_subcommands().front();
    };
    const auto refuse = [&](const std::string& text) {
        return tl::unexpected(
            refusal(app.get_subcommands().empty() ? "lumo" : "lumo " + chosen().get_name(), text));
    };
    try {
        app.parse(argc, argv);
    } catch (const CLI::ExtrasError& error) {
        return refuse(fmt::format("{} ({})", scene::printable(error.what(), 1000), option_names(chosen())));
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == int(CLI::ExitCodes::Success))
            return tl::unexpected(Refusal{.exit_code = exit_done, .text = app.help()});
        return refuse(scene::printable(error.what(), 1000));
    }
    if (version) {
        options.command = Command::version;
        return options;
    }
    if (app.get_subcommands().empty()) return tl::unexpected(Refusal{.text = app.help()});

    options.command = std::ranges::find(commands, chosen().get_name(), &NamedCommand::first)->second;
    if (options.probe.truth.last_order != reference::all_orders)
        options.probe.settings.orders = options.probe.truth.last_order;
    if (!config.empty()) {
        if (const Result<void> done = read_config(config, render_settings); !done)
            return refuse(to_string(done.error()));
    }
    const SettingOptions& settings = options.command == Command::check    ? check_settings
                                     : options.command == Command::bench  ? bench_settings
                                     : options.command == Command::report ? report_settings
                                     : options.command == Command::tune   ? tune_settings
                                                                          : render_settings;
    options.settings = collect(settings);
    for (const auto& [name, option] : settings)
        if (option->count() > 0) options.given.insert(name);
    return options;
}

}  // namespace lumo::program
