#include "samples/lumo/command_line/subcommands.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <iterator>

#include "samples/lumo/bench/bench.hpp"
#include "samples/lumo/command_line/arguments.hpp"
#include "samples/lumo/values.hpp"

namespace lumo::program {
namespace {

void add_validation(CLI::App& app, Options& options) {
    add_flag(app, "--validation", options.validation,
             "the validation layers, or a debug context; what they find fails the run")
        ->envname("LUMO_VALIDATION");
}

}  // namespace

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
    add_flag(app, "--luminance", probe.luminance,
             "one more column: of radiance in cd/m², of irradiance in lx, of all wavelengths at 683 lm/W");
    add(app, "--orders", "N|all", "all",
        "of scattering and reflection by the ground, 1 to 1000: of radiance, inscatter and sky_irradiance",
        into(probe.truth.last_order, parse_orders));
    add(app, "--preset", "fast|default|precise", "default", "of tables and quadratures: error against time",
        [&](const std::string& text) -> Result<void> {
            return atmosphere::parse_preset(text).map(
                [&](atmosphere::Preset preset) { probe.settings = atmosphere::settings_of(preset); });
        });
    add_device_settings(app, options,
                        "the first that works, if not given; both: into NAME.gl.EXT and NAME.vulkan.EXT");
    add_validation(app, options);
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

}  // namespace lumo::program
