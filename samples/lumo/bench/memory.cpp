// `lumo bench memory`: table 2 of the paper (Talcik and Kovacs, mallumo), on the devices at hand.
#include <array>
#include <fmt/format.h>

#include "samples/lumo/bench/bench.hpp"
#include "samples/lumo/input.hpp"
#include "scene/gpu_scene.hpp"
#include "techniques/voxels/octree_statistics.hpp"

namespace lumo::program {
namespace {

using Json = nlohmann::ordered_json;

struct Row {
    uint32_t voxels;
    // The paper's, of Sponza.
    double fragment_list_mib, node_pool_mib;
    uint64_t brick_voxels;

    double ratio() const { return double(brick_voxels) / (double(voxels) * voxels * voxels); }
    uint64_t nodes() const { return brick_voxels / 27; }
};

constexpr std::array<Row, 6> rows_of_paper{{{32, 6.12, 0.03, 55'539},
                                            {64, 7.10, 0.18, 323'811},
                                            {128, 10.48, 0.87, 1'542'483},
                                            {256, 20.80, 3.94, 6'974'235},
                                            {512, 54.22, 17.90, 31'671'459},
                                            {1024, 173.46, 84.21, 149'002'011}}};

double mib(uint64_t bytes) { return double(bytes) / (1 << 20); }

}  // namespace

Result<BenchReport> bench_memory(const Options& options) {
    const auto apis = bench_apis(options);
    if (!apis) return tl::unexpected(apis.error());
    const Result<scene::Scene> scene = load_scene(options);
    if (!scene) return tl::unexpected(scene.error());
    const uint32_t most = options.given.contains("voxels") ? options.frame.voxels.resolution : 1024;

    Progress progress(int(apis->size() * rows_of_paper.size()), options.quiet);
    BenchReport report{
        .json = {{"benchmark", "memory"}, {"scene", options.scene}, {"apis", Json::array()}},
        .text = fmt::format("{}: an octree's size. The paper's nodes: all eight children of each node that "
                            "is split. Bricks: texels\n"
                            "that one direction takes, borders included, and their part of dim³. Paper: "
                            "nodes, MiB of nodes, texels of\n"
                            "bricks and their part of dim³, MiB of fragments, all of Sponza. "
                            "Fragments: MiB at the paper's\n16 bytes each; no list of them is kept.\n",
                            options.scene)};
    for (const rhi::Api api : *apis) {
        auto device = bench_device(api, options);
        if (!device) return tl::unexpected(device.error());
        const auto gpu_scene = scene::GpuScene::create(*device, *scene, options.frame.diffuse_materials);
        if (!gpu_scene) return tl::unexpected(gpu_scene.error());
        const rhi::DeviceInfo& info = device->info();
        Json json{
            {"api", to_string(api)}, {"device", info.name}, {"driver", info.driver}, {"rows", Json::array()}};
        report.text += fmt::format(
            "\n{} on {}, {}\n{:>5}{:>10}{:>10}{:>13}{:>9}{:>12}{:>10}{:>11}{:>9}  | "
            "{:>9}{:>8}{:>12}{:>9}{:>9}\n",
            to_string(api), info.name, info.driver, "dim", "nodes", "MiB", "brick texels", "%", "voxels",
            "MiB", "fragments", "MiB", "nodes", "MiB", "bricks", "%", "MiB");
        for (const Row& row : rows_of_paper) {
            progress.next(fmt::format("{} {}", to_string(api), row.voxels));
            if (row.voxels > most) continue;
            const auto found = voxels::octree_statistics(*device, gpu_scene->view(), row.voxels,
                                                         options.frame.voxels.voxelizer);
            Json entry{{"dim", row.voxels}};
            if (!found) {
                entry["left_out"] = to_string(found.error());
                report.text += fmt::format("{:>5}  {}\n", row.voxels, to_string(found.error()));
                json["rows"].push_back(std::move(entry));
                continue;
            }
            const double cube = double(row.voxels) * row.voxels * row.voxels;
            // Morton key and colour, as a list of fragments would keep them.
            const uint64_t list_bytes = found->surface_cells * 8;
            entry["nodes_as_the_paper_counts"] = found->paper_nodes;
            entry["node_bytes"] = found->node_bytes;
            entry["mark_bytes"] = found->marks_bytes;
            entry["brick_texels"] = found->brick_voxels;
            entry["light_texels"] = found->light_texels;
            entry["brick_part"] = double(found->brick_voxels) / cube;
            entry["occupied"] = found->occupied;
            entry["list_bytes"] = list_bytes;
            entry["fragments"] = found->fragments;
            entry["paper"] = {{"nodes", row.nodes()},
                              {"node_pool_mib", row.node_pool_mib},
                              {"brick_voxels", row.brick_voxels},
                              {"brick_part", row.ratio()},
                              {"fragment_list_mib", row.fragment_list_mib}};
            report.text += fmt::format(
                "{:>5}{:>10}{:>10.2f}{:>13}{:>9.2f}{:>12}{:>10.2f}{:>11}{:>9.2f}  | "
                "{:>9}{:>8.2f}{:>12}{:>9.2f}{:>9.2f}\n",
                row.voxels, found->paper_nodes, mib(found->node_bytes), found->brick_voxels,
                100 * double(found->brick_voxels) / cube, found->occupied.empty() ? 0 : found->occupied[0],
                mib(list_bytes), found->fragments, mib(16 * found->fragments), row.nodes(), row.node_pool_mib,
                row.brick_voxels, 100 * row.ratio(), row.fragment_list_mib);
            json["rows"].push_back(std::move(entry));
        }
        report.json["apis"].push_back(std::move(json));
    }
    return report;
}

}  // namespace lumo::program
