#include "scene/builtin/builtin.hpp"

#include <algorithm>
#include <array>

#include "scene/builtin/scenes.hpp"

namespace lumo::scene {

namespace {

struct Entry {
    std::string_view name;
    Scene (*make)();
};

constexpr std::array entries{
    Entry{"atrium", builtin::make_atrium},         Entry{"cornell", builtin::make_cornell},
    Entry{"area-light", builtin::make_area_light}, Entry{"area-light-pure", builtin::make_area_light_pure},
    Entry{"furnace", builtin::make_furnace},       Entry{"sky", builtin::make_sky},
};

constexpr auto names = [] {
    std::array<std::string_view, entries.size()> result;
    std::ranges::transform(entries, result.begin(), &Entry::name);
    return result;
}();

}  // namespace

std::span<const std::string_view> builtin_names() { return names; }

Result<Scene> make_builtin(std::string_view name) {
    const auto entry = std::ranges::find(entries, name, &Entry::name);
    if (entry == entries.end()) {
        std::string known;
        for (const std::string_view each : names) known += (known.empty() ? "" : ", ") + std::string(each);
        return fail(ErrorKind::invalid_argument, std::string(name), "no built-in scene has this name",
                    "use one of " + known);
    }
    Scene scene = entry->make();
    scene.name = name;
    return scene;
}

}  // namespace lumo::scene
