#include "samples/lumo/probe_sky.hpp"
#include "techniques/atmosphere/stored.hpp"

namespace lumo::program {

Result<std::vector<SkyAnswer>> sky_on_device(rhi::Device& device, const scene::Atmosphere& atmosphere,
                                             const atmosphere::Settings& settings,
                                             std::span<const atmosphere::Question> questions,
                                             const std::function<void(double)>& progress) {
    const auto probe = atmosphere::Probe::create(device);
    if (!probe) return tl::unexpected(probe.error());
    const auto tables = atmosphere::stored_or_precomputed_by_fours(device, atmosphere, settings,
                                                                   rhi::DiskCache::of_user(), progress);
    if (!tables) return tl::unexpected(tables.error());
    const size_t wavelengths = atmosphere.wavelengths_nm.size();
    std::vector<SkyAnswer> answers(questions.size());
    for (const atmosphere::Tables& four : *tables) {
        const auto found = probe->ask(device, four, questions);
        if (!found) return tl::unexpected(found.error());
        for (size_t i = 0; i < answers.size(); ++i) {
            scene::Spectrum& value = answers[i].value;
            for (size_t w = 0; w < atmosphere::max_wavelengths && value.size() < wavelengths; ++w)
                value.push_back(double((*found)[i][w]));
        }
    }
    return answers;
}

}  // namespace lumo::program
