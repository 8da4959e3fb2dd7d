// `lumo probe`: numbers instead of pictures.
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "reference/metrics.hpp"
#include "samples/lumo/commands.hpp"
#include "samples/lumo/open_devices.hpp"
#include "samples/lumo/probe_sky.hpp"
#include "samples/lumo/progress.hpp"
#include "scene/printable.hpp"

namespace lumo::program {
namespace {

using Questions = std::vector<atmosphere::Question>;
using Answers = std::vector<SkyAnswer>;

/// A bar that is told parts, and counts in hundredths.
class Parts {
  public:
    Parts(const Options& options, size_t devices)
        : progress_(int(steps_each * devices), options.quiet), goal_(steps_each) {}

    void next_device() {
        for (; steps_ < goal_; ++steps_) progress_.next("");
        goal_ += steps_each;
    }
    void tell(double part, const std::string& what) {
        for (; double(steps_) < double(goal_) - (1 - part) * double(steps_each); ++steps_)
            progress_.next(what);
    }

  private:
    static constexpr size_t steps_each = 100;
    Progress progress_;
    size_t steps_ = 0;
    size_t goal_;
};

/// NAME.API.EXT
std::filesystem::path tagged(const std::filesystem::path& file, std::string_view tag) {
    std::filesystem::path name = file.stem();
    name += fmt::format(".{}{}", tag, file.extension().string());
    return file.parent_path() / name;
}

/// How many rows are farther apart than two devices may be, by the rule for radiance in pictures; the mean is that of
/// the rows with the same quantity.
size_t rows_apart(const Questions& questions, const Answers& a, const Answers& b, double relative) {
    const size_t wavelengths = a.empty() ? 0 : a.front().value.size();
    std::vector<double> sums(sky_quantities.size() * wavelengths), counts = sums;
    for (size_t i = 0; i < a.size(); ++i) {
        for (size_t w = 0; w < wavelengths; ++w) {
            sums[size_t(questions[i].quantity) * wavelengths + w] += std::abs(a[i].value[w]);
            ++counts[size_t(questions[i].quantity) * wavelengths + w];
        }
    }
    size_t apart = 0;
    for (size_t i = 0; i < a.size(); ++i) {
        bool near = true;
        for (size_t w = 0; w < wavelengths; ++w) {
            const size_t kind = size_t(questions[i].quantity) * wavelengths + w;
            const double x = a[i].value[w], y = b[i].value[w];
            const double scale = std::max({std::abs(x), std::abs(y), sums[kind] / counts[kind]});
            near &= std::abs(x - y) <= relative * scale;
        }
        apart += near ? 0 : 1;
    }
    return apart;
}

/// The table with answers, in a file.
Result<void> write(const std::filesystem::path& file, const Options& options,
                   const scene::Atmosphere& atmosphere, Table table, const Questions& questions,
                   const Answers& answers) {
    const std::string name = scene::printable(options.probe.input.string());
    return add_sky_answers(table, answers, name)
        .and_then([&] {
            return options.probe.luminance
                       ? add_sky_luminance(table, questions, answers, atmosphere.wavelengths_nm, name)
                       : Result<void>{};
        })
        .and_then([&] { return write_table(file, table); });
}

Result<int> probe_devices(const Options& options, const scene::Atmosphere& atmosphere, const Table& table,
                          const Questions& questions) {
    int failures = 0;
    std::vector<Answers> all;
    bool software = true;
    {
        auto devices = open_devices(options, failures);
        if (!devices) return tl::unexpected(devices.error());
        Parts parts(options, devices->size());
        for (rhi::Device& device : *devices) {
            const rhi::DeviceInfo& info = device.info();
            software &= info.software;
            auto answers = sky_on_device(
                device, atmosphere, options.probe.settings, questions,
                [&](double part) { parts.tell(part, fmt::format("{}: precomputing", to_string(info.api))); });
            if (!answers) return tl::unexpected(answers.error());
            const auto file =
                devices->size() == 1 ? options.output : tagged(options.output, to_string(info.api));
            if (const auto done = write(file, options, atmosphere, table, questions, *answers); !done)
                return tl::unexpected(done.error());
            all.push_back(std::move(*answers));
            parts.next_device();
        }
    }
    if (failures > 0)
        return fail(ErrorKind::unsupported, "validation",
                    fmt::format("{} messages that fail a run", failures), "they are above");
    if (all.size() == 1) return exit_done;
    const reference::ParityRule& rule = software ? reference::mesa_parity : reference::hardware_parity;
    const size_t apart = rows_apart(questions, all[0], all[1], rule.relative);
    spdlog::info("{} of {} rows are farther apart than {:g}", apart, questions.size(), rule.relative);
    return double(apart) <= (1 - rule.fraction) * double(questions.size()) ? exit_done : exit_differs;
}

}  // namespace

Result<int> probe(const Options& options) {
    const std::string name = scene::printable(options.probe.input.string());
    const auto atmosphere = options.atmosphere.empty() ? Result<scene::Atmosphere>(scene::earth())
                                                       : scene::load_atmosphere(options.atmosphere);
    if (!atmosphere) return tl::unexpected(atmosphere.error());
    const auto table = read_table(options.probe.input);
    if (!table) return tl::unexpected(table.error());
    const auto questions = read_sky_questions(*table, name);
    if (!questions) return tl::unexpected(questions.error());
    if (!options.reference) return probe_devices(options, *atmosphere, *table, *questions);

    Parts parts(options, 1);
    const Answers answers = sky_truth(reference::AtmosphereOptics(*atmosphere), *questions,
                                      options.probe.truth, [&](size_t done) {
                                          parts.tell(double(done) / double(questions->size()),
                                                     fmt::format("{} of {} rows", done, questions->size()));
                                      });
    return write(options.output, options, *atmosphere, *table, *questions, answers).map([] {
        return int(exit_done);
    });
}

}  // namespace lumo::program
