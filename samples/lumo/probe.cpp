// `lumo probe`: numbers instead of pictures.
#include <fmt/format.h>

#include "samples/lumo/commands.hpp"
#include "samples/lumo/probe_sky.hpp"
#include "samples/lumo/progress.hpp"
#include "scene/printable.hpp"

namespace lumo::program {
namespace {

constexpr int progress_steps = 100;

}  // namespace

Result<int> probe(const Options& options) {
    const std::string name = scene::printable(options.probe.input.string());
    const auto atmosphere = options.probe.atmosphere.empty()
                                ? Result<scene::Atmosphere>(scene::earth())
                                : scene::load_atmosphere(options.probe.atmosphere);
    if (!atmosphere) return tl::unexpected(atmosphere.error());
    auto table = read_table(options.probe.input);
    if (!table) return tl::unexpected(table.error());
    const auto queries = read_sky_queries(*table, name);
    if (!queries) return tl::unexpected(queries.error());

    Progress progress(progress_steps, options.quiet);
    size_t steps = 0;
    const auto answers =
        sky_truth(reference::AtmosphereOptics(*atmosphere), *queries, options.probe.truth, [&](size_t done) {
            for (; steps < done * progress_steps / queries->size(); ++steps)
                progress.next(fmt::format("{} of {} rows", done, queries->size()));
        });
    return add_sky_answers(*table, answers, name)
        .and_then([&] { return write_table(options.output, *table); })
        .map([] { return int(exit_done); });
}

}  // namespace lumo::program
