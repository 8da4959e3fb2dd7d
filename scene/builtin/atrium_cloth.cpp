#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "scene/builtin/atrium.hpp"

namespace lumo::scene::builtin::atrium {

namespace {

constexpr float pi = glm::pi<float>();
constexpr float rod_height = ground_spring - 0.12f;
constexpr float rod_half = 0.5f * bay_width - 0.22f;

void add_rod(Model& to, const Palette& palette) {
    const glm::mat4 lying(glm::vec4(0, -1, 0, 0), glm::vec4(1, 0, 0, 0), glm::vec4(0, 0, 1, 0),
                          glm::vec4(-rod_half, rod_height + 0.03f, 0, 1));
    append(to[palette.bronze], lathe({{{0.022f, 0}, {0.022f, 2 * rod_half}}}, 8), lying);
}

/// Half a curtain from the middle of the bay (s = 0) to the column at +X (s = 1), drawn aside below the rod.
glm::vec3 held_back(float s, float t) {
    const float tie = 0.38f;  // in t
    const float top = rod_height, foot = ground_floor + 0.06f;
    const float y = foot + (top - foot) * t;
    // How far the free edge is drawn to the column: not at the rod, most at the tie, less at the foot.
    const float above = std::clamp((t - tie) / (1 - tie), 0.0f, 1.0f);
    const float below = std::clamp((tie - t) / tie, 0.0f, 1.0f);
    const float drawn =
        t > tie ? 0.76f * std::pow(1 - above, 1.6f) : glm::mix(0.76f, 0.56f, std::sqrt(below) * below);
    const float width = 2 * rod_half * 0.5f * (1 - drawn);
    const float x = rod_half - 0.04f - (1 - s) * width;
    // The edge sags as it is drawn.
    const float sag = 0.22f * drawn * (1 - s) * above;
    const float amplitude = 0.034f;
    const float phase = 2 * pi * 4.5f * s;
    return {x, y - sag, amplitude * std::sin(phase) + 0.012f * std::sin(0.6f * phase + 4 * t)};
}

}  // namespace

Model drawn_curtain(const Finish& cloth, const Palette& palette) {
    Model model;
    add_rod(model, palette);
    const float foot = ground_floor + 0.10f;
    append(model[cloth],
           grid({.columns = 56, .rows = 6, .metres = {3.4f, rod_height - foot}}, [=](float s, float t) {
               const float phase = 2 * pi * 7 * s + 0.8f * std::sin(7 * s);
               const float swing = (1 - t) * (1 - t);
               const float amplitude = 0.05f + 0.035f * swing;
               return glm::vec3((2 * s - 1) * (rod_half - 0.03f) + 0.02f * std::cos(phase) * swing,
                                foot + (rod_height - foot) * t,
                                amplitude * std::sin(phase + 0.5f * std::sin(3 * t)) +
                                    0.10f * swing * std::sin(2.4f * s + 1));
           }));
    return model;
}

Model tied_curtain(const Finish& cloth, const Palette& palette) {
    Model model;
    add_rod(model, palette);
    Geometry half;
    append(half, grid({.columns = 30, .rows = 10, .metres = {1.9f, rod_height - ground_floor}}, held_back));
    append(model[cloth], half);
    append(model[cloth], half, rotation_y(pi));
    // The ties.
    for (const float turn : {0.0f, pi}) {
        append(model[palette.bronze], lathe({{{0.17f, -0.05f}, {0.185f, 0}, {0.17f, 0.05f}}}, 12),
               rotation_y(turn) * translation({rod_half - 0.14f, 1.63f, 0}));
    }
    return model;
}

Model banner(const Finish& cloth, const Finish& trim) {
    constexpr float half_width = 0.62f, behind = 0.45f, length = 2.35f, gap = 0.022f;
    const float rail = upper_floor + 0.98f + gap;
    // Over the rail: up its back, across, and down in front, along one path.
    constexpr float across = 0.34f;
    const auto position = [=](float s, float along) {
        const float point = length - 0.38f * std::abs(2 * s - 1);  // the tail's shape
        const float l = along * (behind + across + point);
        const float x = (2 * s - 1) * half_width;
        const float down = std::max(0.0f, l - behind - across);
        const float wave = std::min(1.0f, down) * (0.05f * std::sin(2 * pi * 1.6f * s + 1.1f * down) +
                                                   0.02f * std::sin(9 * s + 3 * down));
        if (l < behind) return glm::vec3(x, rail - (behind - l), -0.5f * across);
        if (l < behind + across) {
            const float a = (l - behind) / across;
            return glm::vec3(x, rail + 0.02f * std::sin(pi * a), (a - 0.5f) * across);
        }
        // Clear of the cornice below.
        const float clear = 0.5f * across + 0.24f * glm::smoothstep(0.0f, 1.0f, down);
        return glm::vec3(x, rail - down, clear + wave + 0.06f * std::min(1.0f, down));
    };
    constexpr float border = 0.93f;  // the last of its length is trim
    const float metres = behind + across + length;
    // From the tail up, so that its front looks to the court.
    Model model;
    append(model[cloth], grid({.columns = 14, .rows = 14, .metres = {2 * half_width, border * metres}},
                              [=](float s, float t) { return position(s, border * (1 - t)); }));
    append(model[trim], grid({.columns = 14, .rows = 1, .metres = {2 * half_width, (1 - border) * metres}},
                             [=](float s, float t) { return position(s, border + (1 - border) * (1 - t)); }));
    return model;
}

}  // namespace lumo::scene::builtin::atrium
