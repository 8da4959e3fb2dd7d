#include "samples/lumo/probe_sky.hpp"
#include "techniques/atmosphere/stored.hpp"

namespace lumo::program {

Result<std::vector<SkyAnswer>> sky_on_device(rhi::Device& device, const scene::Atmosphere& atmosphere,
                                             const atmosphere::Settings& settings,
                                             std::span<const atmosphere::Question> questions,
                                             const std::function<void(double)>& progress) {
    const auto probe = atmosphere::Probe::create(device);
    if (!probe) return tl::unexpected(probe.error());
    const std::vector<scene::Atmosphere> parts = atmosphere::by_fours(atmosphere);
    std::vector<SkyAnswer> answers(questions.size());
    for (size_t p = 0; p < parts.size(); ++p) {
        const auto tables = atmosphere::stored_or_precomputed(
            device, parts[p], settings, rhi::DiskCache::of_user(),
            [&](double done) { progress((double(p) + done) / double(parts.size())); });
        if (!tables) return tl::unexpected(tables.error());
        const auto found = probe->ask(device, *tables, questions);
        if (!found) return tl::unexpected(found.error());
        for (size_t i = 0; i < answers.size(); ++i)
            for (size_t w = 0; w < parts[p].wavelengths_nm.size(); ++w)
                answers[i].value.push_back(double((*found)[i][w]));
    }
    return answers;
}

}  // namespace lumo::program
