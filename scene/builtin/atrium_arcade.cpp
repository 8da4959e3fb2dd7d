#include <cmath>
#include <glm/gtc/constants.hpp>

#include "scene/builtin/atrium.hpp"

namespace lumo::scene::builtin::atrium {

namespace {

constexpr float half_pi = glm::half_pi<float>();

void add(Profile& profile, std::vector<glm::vec2> points) {
    profile.points.insert(profile.points.end(), points.begin(), points.end());
}

/// A convex half-round moulding between two heights.
std::vector<glm::vec2> torus(float radius, float from, float to, uint32_t segments) {
    const float half = 0.5f * (to - from);
    return arc({radius, from + half}, {half, half}, -half_pi, half_pi, segments);
}

/// Attic base, shaft with entasis and necking. Heights are above the plinth's foot.
struct Shaft {
    float base;  ///< where the base's mouldings begin
    float neck;  ///< where the capital begins
    float foot_radius, neck_radius;
};

Profile shaft_profile(const Shaft& shaft) {
    const float r = shaft.foot_radius;
    Profile profile;
    add(profile, torus(r + 0.02f, shaft.base, shaft.base + 0.10f, 3));
    add(profile, arc({r + 0.045f, shaft.base + 0.135f}, {0.035f, 0.03f}, -half_pi, -3 * half_pi, 2));
    add(profile, torus(r + 0.01f, shaft.base + 0.17f, shaft.base + 0.23f, 2));
    const float foot = shaft.base + 0.24f;
    constexpr int rings = 3;
    for (int i = 0; i <= rings; ++i) {
        const float t = float(i) / rings;
        profile.points.emplace_back(r + (shaft.neck_radius - r) * std::pow(t, 1.8f),
                                    foot + (shaft.neck - 0.05f - foot) * t);
    }
    add(profile, torus(shaft.neck_radius + 0.005f, shaft.neck - 0.05f, shaft.neck, 2));
    return profile;
}

/// An acanthus leaf, reduced: rises along the bell and rolls out at its tip. Foot at the origin, outward +Z.
struct CapitalLeaf {
    float width, height, roll;

    glm::vec3 front(float s, float t) const {
        const float across = 2 * s - 1;
        const float half_width = 0.5f * width * (1 - 0.7f * t * t * t);
        return {across * half_width, height * (1.35f * t - 0.45f * t * t * t),
                0.006f + roll * t * t * t - 2.4f * half_width * half_width * across * across * (1 - t)};
    }

    /// Meets the front at the rim and lies up to 1.4 cm behind it.
    glm::vec3 back(float s, float t) const {
        const float across = 2 * s - 1;
        return front(s, t) + (1 - across * across) * (1 - t * t) * glm::vec3(0, 0.014f, -0.014f);
    }

    Geometry both_faces(uint32_t rows) const {
        const GridShape shape{.columns = 2, .rows = rows, .metres = {width, height}};
        Geometry leaf = grid(shape, [&](float s, float t) { return front(s, t); });
        append(leaf, reversed(grid(shape, [&](float s, float t) { return back(s, t); })));
        return leaf;
    }
};

/// A square slab with a moulded edge, its top at height.
Geometry abacus(float apothem, float foot, float top) {
    const float h = top - foot;
    return prism({{{0.5f * apothem, foot},
                   {apothem - 0.05f, foot},
                   {apothem - 0.02f, foot + 0.35f * h},
                   {apothem - 0.02f, foot + 0.45f * h},
                   {apothem, foot + 0.55f * h},
                   {apothem, top},
                   {0, top}}},
                 4);
}

/// The wall of a bay over its arch, in the XY plane: from the springing line up to height, less the arch's disc.
Geometry arched_panel(float half_width, float height, float radius, uint32_t segments) {
    const float corner = std::atan2(height, half_width);
    std::vector<float> angles;
    for (uint32_t i = 0; i <= segments; ++i) {
        const float even = glm::pi<float>() * float(i) / float(segments);
        const float spacing = 0.5f * glm::pi<float>() / float(segments);
        // The rectangle's corners must be among the angles.
        if (std::abs(even - corner) < spacing) {
            angles.push_back(corner);
        } else if (std::abs(even - (glm::pi<float>() - corner)) < spacing) {
            angles.push_back(glm::pi<float>() - corner);
        } else {
            angles.push_back(even);
        }
    }
    Geometry result;
    for (const float angle : angles) {
        const glm::vec2 direction(std::cos(angle), std::sin(angle));
        const float reach = std::min(half_width / std::max(std::abs(direction.x), 1e-6f),
                                     height / std::max(direction.y, 1e-6f));
        for (const float distance : {radius, reach}) {
            const glm::vec2 p = distance * direction;
            result.vertices.push_back(
                {.position = {p, 0}, .normal = {0, 0, 1}, .tangent = {1, 0, 0, 1}, .uv0 = {p.x, -p.y}});
        }
    }
    for (uint32_t i = 0; i < segments; ++i) {
        const uint32_t a = 2 * i;
        result.indices.insert(result.indices.end(), {a, a + 1, a + 3, a, a + 3, a + 2});
    }
    return result;
}

/// A wedge of the arch between two angles from +x; z is its half depth.
Geometry voussoir(float from, float to, float inner, float outer, float back, float front) {
    const auto corner = [](float angle, float radius, float z) {
        return glm::vec3(radius * std::cos(angle), radius * std::sin(angle), z);
    };
    return block({corner(to, inner, front), corner(from, inner, front), corner(from, inner, back),
                  corner(to, inner, back)},
                 {corner(to, outer, front), corner(from, outer, front), corner(from, outer, back),
                  corner(to, outer, back)});
}

/// Front and back of the wall over an arch, a thickness apart.
void add_wall(Geometry& to, float spring, float top) {
    const Geometry face = arched_panel(0.5f * bay_width, top - spring, arch_radius + arch_ring - 0.01f, 18);
    append(to, face, translation({0, spring, wall_half}));
    append(to, face, translation({0, spring, -wall_half}) * rotation_y(glm::pi<float>()));
}

}  // namespace

Model ground_column(const Palette& palette) {
    const float height = ground_spring - ground_floor;
    const float neck = height - 0.62f;
    Geometry stone = prism({{{0.35f, 0}, {0.35f, 0.115f}, {0.335f, 0.13f}, {0.2f, 0.13f}}}, 4);
    Profile profile =
        shaft_profile({.base = 0.13f, .neck = neck, .foot_radius = 0.245f, .neck_radius = 0.205f});
    add(profile,
        {{0.2f, neck + 0.02f}, {0.205f, neck + 0.2f}, {0.225f, neck + 0.34f}, {0.275f, neck + 0.46f}});
    append(stone, lathe(profile, 14));
    append(stone, abacus(0.335f, height - 0.17f, height));
    // Eight leaves lie on the bell; four larger ones carry the abacus at its corners.
    const Geometry low = CapitalLeaf{.width = 0.15f, .height = 0.24f, .roll = 0.08f}.both_faces(3);
    const Geometry corner = CapitalLeaf{.width = 0.12f, .height = 0.37f, .roll = 0.17f}.both_faces(4);
    for (int i = 0; i < 8; ++i) {
        const glm::mat4 turn = rotation_y(half_pi * 0.5f * float(i));
        append(stone, low, turn * translation({0, neck + 0.01f, 0.205f}));
    }
    for (int i = 0; i < 4; ++i) {
        const glm::mat4 turn = rotation_y(half_pi * (float(i) + 0.5f));
        append(stone, corner, turn * translation({0, neck + 0.08f, 0.215f}));
    }
    Model model;
    append(model[palette.limestone], stone, translation({0, ground_floor, 0}));
    return model;
}

Model upper_column(const Palette& palette) {
    const float height = upper_spring - upper_floor;
    Geometry stone = prism({{{0.31f, 0},
                             {0.31f, 0.12f},
                             {0.27f, 0.16f},
                             {0.27f, pedestal - 0.12f},
                             {0.30f, pedestal - 0.08f},
                             {0.30f, pedestal - 0.02f},
                             {0.28f, pedestal},
                             {0, pedestal}}},
                           4);
    append(stone, prism({{{0.27f, pedestal}, {0.27f, pedestal + 0.08f}, {0.1f, pedestal + 0.08f}}}, 4));
    const float neck = height - 0.26f;
    Profile profile =
        shaft_profile({.base = pedestal + 0.08f, .neck = neck, .foot_radius = 0.19f, .neck_radius = 0.165f});
    add(profile, {{0.165f, neck + 0.08f}});
    add(profile, arc({0.18f, neck + 0.14f}, {0.08f, 0.06f}, -half_pi, 0, 3));
    append(stone, lathe(profile, 12));
    append(stone, abacus(0.33f, height - 0.13f, height));
    Model model;
    append(model[palette.limestone], stone, translation({0, upper_floor, 0}));
    return model;
}

Model corner_pier(const Palette& palette) {
    const auto storey = [](float floor, float spring, float top) {
        return prism({{{0.40f, floor},
                       {0.40f, floor + 0.26f},
                       {0.345f, floor + 0.33f},
                       {0.345f, spring - 0.32f},
                       {0.365f, spring - 0.30f},
                       {0.365f, spring - 0.26f},
                       {0.345f, spring - 0.24f},
                       {0.345f, spring - 0.14f},
                       {0.385f, spring - 0.09f},
                       {0.385f, spring},
                       {0.29f, spring},
                       {0.29f, top}}},
                     4);
    };
    Model model;
    append(model[palette.limestone], storey(ground_floor, ground_spring, upper_floor - 0.02f));
    append(model[palette.limestone], storey(upper_floor, upper_spring, wall_top));
    return model;
}

Model ground_arch(const Palette& palette) {
    Model model;
    add_wall(model[palette.ashlar], ground_spring, upper_floor - 0.02f);
    const float w = wall_half, r = arch_ring;
    append(model[palette.limestone],
           archivolt({{{-w, r}, {-w - 0.03f, r}, {-w - 0.03f, 0}, {w + 0.03f, 0}, {w + 0.03f, r}, {w, r}}},
                     glm::vec2(arch_radius), 16),
           translation({0, ground_spring, 0}));

    constexpr int stones = 15;  // an odd number puts a stone at the crown
    const float angle = glm::pi<float>() / stones;
    for (int i = 1; i < stones; i += 2) {
        const bool key = i == stones / 2;
        const float joint = 0.004f;
        append(model[key ? palette.limestone : palette.rosso],
               voussoir(angle * float(i) + joint, angle * float(i + 1) - joint,
                        arch_radius - (key ? 0.035f : 0.014f), arch_radius + r + (key ? 0.09f : 0.015f),
                        -w - 0.05f, w + (key ? 0.12f : 0.05f)),
               translation({0, ground_spring, 0}));
    }
    return model;
}

Model upper_arch(const Palette& palette) {
    Model model;
    add_wall(model[palette.rose_plaster], upper_spring, wall_top);
    const float w = wall_half, r = arch_ring;
    append(model[palette.limestone],
           archivolt({{{-w, r},
                       {-w - 0.03f, r},
                       {-w - 0.03f, 0},
                       {w + 0.02f, 0},
                       {w + 0.02f, 0.09f},
                       {w + 0.045f, 0.09f},
                       {w + 0.045f, 0.18f},
                       {w + 0.075f, 0.215f},
                       {w + 0.075f, r},
                       {w, r}}},
                     glm::vec2(arch_radius), 16),
           translation({0, upper_spring, 0}));
    append(model[palette.limestone],
           voussoir(half_pi - 0.09f, half_pi + 0.09f, arch_radius - 0.03f, arch_radius + r + 0.1f, -w - 0.05f,
                    w + 0.13f),
           translation({0, upper_spring, 0}));
    return model;
}

Model balustrade(const Palette& palette) {
    const float half_span = 0.5f * bay_width - 0.26f;  // into the pedestals
    Geometry stone = box({-half_span, 0, -0.12f}, {half_span, 0.13f, 0.12f});
    const Profile rail{{{-0.12f, 0.86f},
                        {0.12f, 0.86f},
                        {0.15f, 0.90f},
                        {0.15f, 0.95f},
                        {0.13f, 0.98f},
                        {-0.13f, 0.98f},
                        {-0.15f, 0.95f},
                        {-0.15f, 0.90f},
                        {-0.12f, 0.86f}}};
    append(stone, moulding(rail, 2 * half_span), translation({-half_span, 0, 0}));
    const Geometry baluster = lathe({{{0.075f, 0.12f},
                                      {0.075f, 0.17f},
                                      {0.045f, 0.20f},
                                      {0.078f, 0.32f},
                                      {0.072f, 0.42f},
                                      {0.036f, 0.62f},
                                      {0.034f, 0.74f},
                                      {0.062f, 0.79f},
                                      {0.062f, 0.87f}}},
                                    7);
    constexpr int count = 5;
    for (int i = 0; i < count; ++i) {
        append(stone, baluster, translation({2 * half_span * ((float(i) + 0.5f) / count - 0.5f), 0, 0}));
    }
    Model model;
    append(model[palette.limestone], stone, translation({0, upper_floor, 0}));
    return model;
}

Model roundel(const Palette& palette) {
    // Turned about +Y, then laid against the wall.
    const glm::mat4 on_wall(glm::vec4(1, 0, 0, 0), glm::vec4(0, 0, 1, 0), glm::vec4(0, -1, 0, 0),
                            glm::vec4(0, ground_spring + 0.98f, wall_half, 1));
    Model model;
    append(model[palette.limestone],
           lathe({{{0.29f, -0.02f},
                   {0.29f, 0.03f},
                   {0.265f, 0.055f},
                   {0.235f, 0.055f},
                   {0.215f, 0.02f},
                   {0.21f, 0.0f}}},
                 12),
           on_wall);
    append(model[palette.glaze], lathe({{{0.215f, 0.012f}, {0.14f, 0.022f}, {0.07f, 0.05f}, {0, 0.06f}}}, 12),
           on_wall);
    return model;
}

}  // namespace lumo::scene::builtin::atrium
