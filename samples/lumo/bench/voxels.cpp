// `lumo bench voxels`: table 1 of the paper (Talcik and Kovacs, mallumo), on the devices at hand.
#include <array>
#include <fmt/format.h>
#include <map>
#include <optional>

#include "samples/lumo/bench/bench.hpp"
#include "samples/lumo/input.hpp"
#include "samples/lumo/trial.hpp"
#include "scene/gpu_scene.hpp"
#include "techniques/frame/frame.hpp"

namespace lumo::program {
namespace {

using Json = nlohmann::ordered_json;
using voxels::MipKind;
using voxels::Storage;

constexpr std::array cone_counts{3, 9, 18};

/// Milliseconds: voxelization, injection of light with its mips, and cones by their number.
template <class T>
struct Columns {
    T voxelize;
    T inject;
    std::array<T, cone_counts.size()> cones;
};

struct Row {
    Storage storage;
    MipKind mips;
    bool wide;  ///< the paper's HDR
    uint32_t voxels;
    Columns<double> paper;  ///< on a GTX 1070, image size not stated

    std::string name() const {
        return fmt::format("{} {} {} {}", storage == Storage::dense ? "VT" : "SVO",
                           mips == MipKind::isotropic ? "ISO" : "ANI", wide ? "HDR" : "LDR", voxels);
    }
};

constexpr std::array<Row, 12> rows_of_paper{{
    {Storage::dense, MipKind::isotropic, false, 256, {5.03, 1.17, {1.42, 4.17, 10.00}}},
    {Storage::dense, MipKind::isotropic, false, 512, {24.53, 7.80, {1.53, 4.71, 11.59}}},
    {Storage::dense, MipKind::isotropic, true, 256, {14.33, 3.36, {4.83, 22.87, 60.03}}},
    {Storage::dense, MipKind::anisotropic, false, 256, {6.10, 1.55, {1.61, 4.50, 10.10}}},
    {Storage::dense, MipKind::anisotropic, false, 512, {34.11, 10.72, {1.70, 5.96, 13.17}}},
    {Storage::dense, MipKind::anisotropic, true, 256, {19.80, 4.50, {6.74, 28.00, 68.52}}},
    {Storage::octree, MipKind::isotropic, false, 256, {787.51, 76.55, {4.04, 22.00, 60.52}}},
    {Storage::octree, MipKind::isotropic, false, 512, {2201.27, 124.79, {4.81, 26.61, 74.01}}},
    {Storage::octree, MipKind::isotropic, true, 256, {725.39, 74.44, {5.80, 31.16, 84.90}}},
    {Storage::octree, MipKind::anisotropic, false, 256, {954.42, 130.45, {3.14, 13.27, 34.07}}},
    {Storage::octree, MipKind::anisotropic, false, 512, {2759.37, 367.47, {3.60, 16.55, 41.98}}},
    {Storage::octree, MipKind::anisotropic, true, 256, {948.32, 144.43, {7.47, 30.94, 76.71}}},
}};

/// The paper's rows, or those of 256 with another number of voxels, whose figures are then nobody's.
std::vector<Row> rows_of(const Options& options) {
    std::vector<Row> rows;
    for (Row row : rows_of_paper) {
        if (options.given.contains("voxels")) {
            if (row.voxels != 256) continue;
            row.voxels = options.frame.voxels.resolution;
        }
        rows.push_back(row);
    }
    return rows;
}

/// Medians of a row, and why it has none.
struct Measured {
    Columns<Spread> times;
    uint64_t bytes = 0;  ///< of the voxels
    std::optional<Error> error = {};
};

/// Names of passes, as voxels::Volume has them.
bool is_injection(std::string_view pass) { return pass == "voxels.light" || pass == "voxels.inject"; }
bool is_voxelization(std::string_view pass) {
    return !is_injection(pass) && (pass.starts_with("voxels.") || pass.starts_with("octree."));
}

class Bench {
  public:
    Bench(rhi::Device& device, const scene::Scene& scene, const scene::Camera& camera, const Options& options)
        : device_(device), scene_(scene), camera_(camera), options_(options) {}

    /// What does not fit is an error of the row, and not of the run.
    Result<Measured> measure(const Row& row, const scene::GeometryView& geometry) {
        Measured measured;
        std::vector<double> voxelize, inject;
        for (size_t i = 0; i < cone_counts.size(); ++i) {
            frame::Settings settings = options_.frame;
            settings.gi = true;
            settings.bounces = 1;
            settings.layers = {frame::Layer::radiance};
            settings.voxels.storage = row.storage;
            settings.voxels.mips = row.mips;
            settings.voxels.resolution = row.voxels;
            settings.range = range_of(row);
            settings.cones.count = cone_counts[i];
            std::vector<double> cones;
            Result<void> done = run(settings, geometry, measured, voxelize, inject, cones);
            if (!done) {
                if (!does_not_fit(done.error())) return tl::unexpected(done.error());
                measured.error = done.error();
                return measured;
            }
            measured.times.cones[i] = spread_of(std::move(cones));
        }
        measured.times.voxelize = spread_of(std::move(voxelize));
        measured.times.inject = spread_of(std::move(inject));
        return measured;
    }

    /// The range that was asked for, in the rows whose light it can hold.
    voxels::Range range_of(const Row& row) const {
        const std::optional<voxels::Range> asked = options_.frame.range;
        if (asked && voxels::is_wide(*asked) == row.wide) return *asked;
        return row.wide ? voxels::Range::fixed : voxels::Range::ldr;
    }

  private:
    /// Frames of these settings, the first of which warms up.
    Result<void> run(const frame::Settings& asked, const scene::GeometryView& geometry, Measured& measured,
                     std::vector<double>& voxelize, std::vector<double>& inject, std::vector<double>& cones) {
        const frame::SceneFacts facts = frame::examine(scene_, asked);
        const frame::Settings settings = frame::resolve(asked, facts);
        auto frame =
            frame::Frame::create(device_, settings, frame::make_plan(facts, settings), facts, geometry);
        if (!frame) return tl::unexpected(frame.error());
        measured.bytes = 0;
        for (const rhi::MemoryEntry& entry : device_.memory())
            if (is_voxelization(entry.name)) measured.bytes += entry.bytes;
        // Software drivers take memory only once it is written, and then it is too late to refuse.
        const rhi::MemoryBudget budget = device_.memory_budget();
        if (budget.budget_bytes > 0 && measured.bytes > budget.budget_bytes)
            return fail(ErrorKind::out_of_memory, "voxels",
                        fmt::format("{} MiB are needed and {} MiB are free", measured.bytes >> 20,
                                    budget.budget_bytes >> 20),
                        "use fewer voxels or --storage svo");

        const frame::Inputs inputs{
            .geometry = geometry, .camera = camera_, .lights = shadow::drawn_lights(scene_.lights)};
        for (uint32_t i = 0; i <= options_.runs; ++i) {
            rhi::Commands commands = device_.begin();
            frame->record(commands, inputs);
            const rhi::Submission submission = device_.submit(std::move(commands));
            if (Result<void> done = device_.wait(submission); !done) return done;
            if (i == 0) continue;
            double v = 0, ri = 0, ct = 0;
            for (const rhi::PassTime& pass : device_.pass_times(submission)) {
                if (is_injection(pass.name))
                    ri += pass.milliseconds;
                else if (is_voxelization(pass.name))
                    v += pass.milliseconds;
                else if (pass.name == "cones.irradiance")
                    ct += pass.milliseconds;
            }
            voxelize.push_back(v);
            inject.push_back(ri);
            cones.push_back(ct);
        }
        return {};
    }

    rhi::Device& device_;
    const scene::Scene& scene_;
    const scene::Camera& camera_;
    const Options& options_;
};

/// One figure of a table by another, of lumo and of the paper.
struct Ratio {
    std::string what;
    double aim;          ///< at most
    size_t over, under;  ///< rows of rows_of_paper, with 256 voxels
    double (*column)(const Columns<double>&);
};

std::array<Ratio, 6> ratios(bool software) {
    constexpr auto voxelize = [](const Columns<double>& c) { return c.voxelize; };
    constexpr auto nine_cones = [](const Columns<double>& c) { return c.cones[1]; };
    return {{{"HDR / LDR, voxelization", 1.5, 2, 0, voxelize},
             {"HDR / LDR, CT_9", 1.5, 2, 0, nine_cones},
             {"SVO / VT, voxelization", 5, 6, 0, voxelize},
             {"SVO / VT, CT_9", 2.5, 6, 0, nine_cones},
             {"ANI / ISO, voxelization", 1.2, 3, 0, voxelize},
             {"ANI / ISO, CT_9", software ? 1.6 : 1.1, 3, 0, nine_cones}}};
}

Columns<double> medians(const Columns<Spread>& spreads) {
    Columns<double> columns{spreads.voxelize.median, spreads.inject.median, {}};
    for (size_t i = 0; i < cone_counts.size(); ++i) columns.cones[i] = spreads.cones[i].median;
    return columns;
}

Json to_json(const Columns<double>& columns) {
    Json json{{"V", columns.voxelize}, {"RI", columns.inject}};
    for (size_t i = 0; i < cone_counts.size(); ++i)
        json[fmt::format("CT_{}", cone_counts[i])] = columns.cones[i];
    return json;
}

Json to_json(const Columns<Spread>& columns) {
    Json json{{"V", program::to_json(columns.voxelize)}, {"RI", program::to_json(columns.inject)}};
    for (size_t i = 0; i < cone_counts.size(); ++i)
        json[fmt::format("CT_{}", cone_counts[i])] = program::to_json(columns.cones[i]);
    return json;
}

std::string to_text(const Columns<double>& columns) {
    std::string text = fmt::format("{:>10.2f}{:>10.2f}", columns.voxelize, columns.inject);
    for (const double cones : columns.cones) text += fmt::format("{:>10.2f}", cones);
    return text;
}

/// The measured rows of one device, by their place in rows_of().
void add_ratios(const std::map<std::string, Columns<double>>& measured, uint32_t voxels, bool software,
                Json& json, std::string& text) {
    json = Json::array();
    for (const Ratio& ratio : ratios(software)) {
        Row over = rows_of_paper[ratio.over], under = rows_of_paper[ratio.under];
        const double paper = ratio.column(over.paper) / ratio.column(under.paper);
        over.voxels = under.voxels = voxels;
        const auto a = measured.find(over.name()), b = measured.find(under.name());
        if (a == measured.end() || b == measured.end()) continue;
        const double value = ratio.column(a->second) / ratio.column(b->second);
        text +=
            fmt::format("  {:<28}{:>8.2f}   aim {:<5g} paper {:.2f}\n", ratio.what, value, ratio.aim, paper);
        json.push_back({{"what", ratio.what}, {"ratio", value}, {"aim", ratio.aim}, {"paper", paper}});
    }
}

}  // namespace

Result<BenchReport> bench_voxels(const Options& asked) {
    Options options = asked;
    if (!options.given.contains("runs")) options.runs = 100;
    if (!options.given.contains("size")) options.frame.size = {1920, 1080};
    const auto apis = bench_apis(options);
    if (!apis) return tl::unexpected(apis.error());
    Result<scene::Scene> scene = load_scene(options);
    if (!scene) return tl::unexpected(scene.error());
    scene->environment_radiance = {};  // the sun alone, as in the paper
    const auto camera = choose_camera(options, *scene);
    if (!camera) return tl::unexpected(camera.error());

    const std::vector<Row> rows = rows_of(options);
    const uint32_t ratio_voxels = rows.front().voxels;
    const bool papers = !options.given.contains("voxels");
    Progress progress(int(apis->size() * rows.size()), options.quiet);
    BenchReport report{.json = {{"benchmark", "voxels"},
                                {"scene", options.scene},
                                {"size", {options.frame.size.width, options.frame.size.height}},
                                {"runs", options.runs},
                                {"apis", Json::array()}},
                       .text = {}};
    report.text = fmt::format(
        "{} at {}x{}, ms, medians of {} runs: V voxelization, RI injection and its mips, CT_n n cones a "
        "pixel\n",
        options.scene, options.frame.size.width, options.frame.size.height, options.runs);
    for (const rhi::Api api : *apis) {
        auto device = bench_device(api, options);
        if (!device) return tl::unexpected(device.error());
        const auto gpu_scene = scene::GpuScene::create(*device, *scene, options.frame.diffuse_materials);
        if (!gpu_scene) return tl::unexpected(gpu_scene.error());
        Bench bench(*device, *scene, *camera, options);

        const rhi::DeviceInfo& info = device->info();
        Json json{
            {"api", to_string(api)}, {"device", info.name}, {"driver", info.driver}, {"rows", Json::array()}};
        report.text +=
            fmt::format("\n{} on {}, {}\n{:<18}{:>10}{:>10}{:>10}{:>10}{:>10}{:>10}\n", to_string(api),
                        info.name, info.driver, "", "V", "RI", "CT_3", "CT_9", "CT_18", "MiB");
        std::map<std::string, Columns<double>> measured;
        for (const Row& row : rows) {
            progress.next(fmt::format("{} {}", to_string(api), row.name()));
            const auto found = bench.measure(row, gpu_scene->view());
            if (!found) return tl::unexpected(found.error());
            Json entry{{"row", row.name()},
                       {"range", voxels::to_string(bench.range_of(row))},
                       {"voxel_bytes", found->bytes}};
            if (papers) entry["paper_ms"] = to_json(row.paper);
            if (found->error) {
                entry["left_out"] = to_string(*found->error);
                report.text += fmt::format("{:<18}  {}\n", row.name(), to_string(*found->error));
            } else {
                entry["ms"] = to_json(found->times);
                measured.emplace(row.name(), medians(found->times));
                report.text += fmt::format("{:<18}{}{:>10}\n", row.name(), to_text(medians(found->times)),
                                           found->bytes >> 20);
                if (papers) report.text += fmt::format("{:<18}{}\n", "  the paper's", to_text(row.paper));
            }
            json["rows"].push_back(std::move(entry));
        }
        report.text += "\nratios\n";
        add_ratios(measured, ratio_voxels, info.software, json["ratios"], report.text);
        report.json["apis"].push_back(std::move(json));
    }
    return report;
}

}  // namespace lumo::program
