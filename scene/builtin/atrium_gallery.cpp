#include <cmath>
#include <glm/gtc/constants.hpp>

#include "scene/builtin/atrium.hpp"

namespace lumo::scene::builtin::atrium {

namespace {

constexpr float pi = glm::pi<float>();
constexpr float vault_rise = 1.42f;
constexpr float vault_half_depth = 0.5f * (gallery_depth - wall_half);
constexpr float vault_center = -wall_half - vault_half_depth;  // z in a side's frame

/// One of a groin vault's four webs, seen from below: of the barrel along Z, from the crown to z = half.y.
Geometry vault_web(glm::vec2 half) {
    return grid({.columns = 6, .rows = 5, .metres = {0.5f * pi * half.x, half.y}}, [=](float s, float t) {
        const float turn = 0.5f * pi * t;
        const float across = (2 * s - 1) * turn;
        return glm::vec3(half.x * std::sin(across), vault_rise * std::cos(across), half.y * std::sin(turn));
    });
}

/// A field that stands out from the XY plane with sloped edges.
Geometry raised_field(glm::vec2 min, glm::vec2 max, float depth) {
    const glm::vec2 inner_min = min + 0.05f, inner_max = max - 0.05f;
    return block({{{min, 0}, {max.x, min.y, 0}, {max, 0}, {min.x, max.y, 0}}},
                 {{{inner_min, depth},
                   {inner_max.x, inner_min.y, depth},
                   {inner_max, depth},
                   {inner_min.x, inner_max.y, depth}}});
}

constexpr float frame_foot = 0.16f;  // how far frames and leaves reach back from their front's plane

/// A wooden leaf of that size about x = 0 with raised fields, its foot at the origin, standing 4 cm out.
Geometry wooden_leaf(glm::vec2 size, int fields) {
    Geometry wood = box({-0.5f * size.x, 0, -frame_foot}, {0.5f * size.x, size.y, 0.04f});
    const float height = (size.y - 0.09f) / float(fields);
    for (int i = 0; i < fields; ++i) {
        const glm::vec2 min(-0.5f * size.x + 0.08f, 0.09f + height * float(i));
        append(wood, raised_field(min, min + glm::vec2(size.x - 0.16f, height - 0.09f), 0.03f),
               translation({0, 0, 0.04f}));
    }
    return wood;
}

/// Jambs and lintel of that width about an opening, with a cornice over them.
Geometry opening_frame(glm::vec2 opening, float width) {
    const float half = 0.5f * opening.x;
    Geometry stone = box({-half - width, 0, -frame_foot}, {-half, opening.y, 0.12f});
    append(stone, box({half, 0, -frame_foot}, {half + width, opening.y, 0.12f}));
    append(stone, box({-half - width - 0.02f, opening.y, -frame_foot},
                      {half + width + 0.02f, opening.y + width, 0.14f}));
    const float foot = opening.y + width;
    const Profile cornice{{{0.0f, foot - 0.01f},
                           {0.14f, foot},
                           {0.20f, foot + 0.06f},
                           {0.20f, foot + 0.09f},
                           {0.26f, foot + 0.13f},
                           {0.26f, foot + 0.16f},
                           {0.0f, foot + 0.20f}}};
    const float length = opening.x + 2 * width + 0.04f;
    append(stone, moulding(cornice, length, -1, -1), translation({-0.5f * length, 0, 0}));
    // The cornice turns back to the wall at its ends.
    append(stone, moulding(cornice, frame_foot, 0, -1),
           translation({-0.5f * length, 0, -frame_foot}) * rotation_y(-0.5f * pi));
    append(stone, moulding(cornice, frame_foot, -1, 0),
           translation({0.5f * length, 0, 0}) * rotation_y(0.5f * pi));
    return stone;
}

/// Where an opening stands: clear of the dado, which runs on behind it.
glm::mat4 on_back_wall(float height) { return translation({0, height, -gallery_depth + 0.1f}); }

constexpr glm::vec2 eave{0.85f, 11.14f};  // z and y in a side's frame
constexpr glm::vec2 ridge{-gallery_depth - back_wall - 0.2f, 13.0f};

/// Half-round tiles down the slope; the roof's mitred corners shorten those beyond the columns' corner axes.
void add_tiles(Geometry& to, float side_length) {
    constexpr float radius = 0.085f, spacing = 0.235f;
    const glm::vec2 slope = glm::normalize(eave - ridge);
    const glm::vec3 outward(0, slope.x, -slope.y);
    const Profile half_round{arc({0, 0}, glm::vec2(radius), -0.5f * pi, 0.5f * pi, 4)};
    const Geometry end = grid({.columns = 4, .rows = 1, .metres = glm::vec2(radius)}, [&](float s, float t) {
        return t * radius * (-std::cos(pi * s) * glm::vec3(1, 0, 0) + std::sin(pi * s) * outward);
    });
    const auto half_count = int((0.5f * side_length - ridge.x) / spacing);
    for (int i = -half_count; i <= half_count; ++i) {
        const float x = spacing * float(i);
        const float foot_z = std::min(eave.x, 0.5f * side_length - std::abs(x));
        const glm::vec3 foot(x, eave.y + (foot_z - eave.x) * slope.y / slope.x, foot_z);
        const glm::vec3 top(x, ridge.y, ridge.x);
        const float length = glm::distance(foot, top);
        if (length < 0.3f) continue;
        const std::array frames{
            SweepFrame{.origin = top, .x_axis = outward, .y_axis = {1, 0, 0}},
            SweepFrame{.origin = foot, .x_axis = outward, .y_axis = {1, 0, 0}, .u = length}};
        append(to, sweep(half_round, frames));
        append(to, end, translation(foot));
    }
}

void add_roof(Model& to, const Palette& palette, float length) {
    const glm::mat4 start = translation({-0.5f * length, 0, 0});
    append(to[palette.clay],
           moulding({{{eave.x, eave.y - 0.07f},
                      eave,
                      ridge,
                      {ridge.x, ridge.y - 0.4f},
                      {-gallery_depth, ridge.y - 0.4f}}},
                    length, 1, 1),
           start);
    append(to[palette.wood],
           moulding({{{wall_half - 0.02f, wall_top - 0.02f}, {eave.x, eave.y - 0.07f}}}, length, 1, 1),
           start);
    add_tiles(to[palette.clay], length);
    const int rafters = int(length / 0.7f);
    for (int i = 0; i < rafters; ++i) {
        const float x = -0.5f * length + 0.35f + 0.7f * float(i);
        const float foot = wall_top - 0.16f, tip = eave.y - 0.07f;
        append(to[palette.wood], block({{{x - 0.06f, tip - 0.08f, eave.x - 0.07f},
                                         {x + 0.06f, tip - 0.08f, eave.x - 0.07f},
                                         {x + 0.06f, foot, wall_half - 0.05f},
                                         {x - 0.06f, foot, wall_half - 0.05f}}},
                                       {{{x - 0.06f, tip + 0.03f, eave.x - 0.07f},
                                         {x + 0.06f, tip + 0.03f, eave.x - 0.07f},
                                         {x + 0.06f, wall_top, wall_half - 0.05f},
                                         {x - 0.06f, wall_top, wall_half - 0.05f}}}));
    }
}

void add_cornices(Model& to, const Palette& palette, float length) {
    const glm::mat4 start = translation({-0.5f * length, 0, 0});
    const float w = wall_half, g = upper_floor, u = wall_top;
    append(to[palette.limestone],
           moulding({{{w, g - 0.54f},
                      {w + 0.03f, g - 0.54f},
                      {w + 0.03f, g - 0.45f},
                      {w + 0.05f, g - 0.45f},
                      {w + 0.05f, g - 0.37f},
                      {w + 0.02f, g - 0.36f},
                      {w + 0.02f, g - 0.25f},
                      {w + 0.08f, g - 0.21f},
                      {w + 0.22f, g - 0.17f},
                      {w + 0.22f, g - 0.09f},
                      {w + 0.28f, g - 0.04f},
                      {w + 0.28f, g - 0.01f},
                      {w, g}}},
                    length, 1, 1),
           start);
    append(to[palette.limestone],
           moulding({{{w, u - 0.72f},
                      {w + 0.03f, u - 0.72f},
                      {w + 0.03f, u - 0.62f},
                      {w + 0.055f, u - 0.62f},
                      {w + 0.055f, u - 0.52f},
                      {w + 0.085f, u - 0.48f},
                      {w + 0.085f, u - 0.45f},
                      {w + 0.02f, u - 0.43f},
                      {w + 0.02f, u - 0.26f},
                      {w + 0.10f, u - 0.20f},
                      {w + 0.10f, u - 0.14f},
                      {w + 0.16f, u - 0.09f},
                      {w + 0.16f, u}}},
                    length, 1, 1),
           start);
}

void add_back_wall(Model& to, const Palette& palette, float length, bool whole) {
    const glm::mat4 start = translation({-0.5f * length, 0, 0});
    const float d = gallery_depth;
    // The long walls take the corners; the short ones end inside them.
    const float half = 0.5f * length + d + (whole ? back_wall : 0.2f);
    const float joint = upper_floor - 0.2f;
    append(to[palette.plaster], box({-half, -0.3f, -d - back_wall}, {half, joint, -d}));
    append(to[palette.rose_plaster], box({-half, joint, -d - back_wall}, {half, ridge.y - 0.35f, -d}));
    const float g = ground_floor, u = upper_floor;
    append(
        to[palette.ashlar],
        moulding({{{-d + 0.09f, g}, {-d + 0.09f, g + 0.16f}, {-d + 0.06f, g + 0.2f}, {-d + 0.06f, g + 1.0f}}},
                 length, 1, 1),
        start);
    append(to[palette.limestone],
           moulding(
               {{{-d + 0.06f, g + 1.0f}, {-d + 0.11f, g + 1.04f}, {-d + 0.11f, g + 1.09f}, {-d, g + 1.13f}}},
               length, 1, 1),
           start);
    append(to[palette.limestone],
           moulding({{{-d + 0.04f, u}, {-d + 0.04f, u + 0.28f}, {-d, u + 0.32f}}}, length, 1, 1), start);
    append(to[palette.limestone],
           moulding({{{-d, ceiling - 0.42f},
                      {-d + 0.05f, ceiling - 0.38f},
                      {-d + 0.05f, ceiling - 0.28f},
                      {-d + 0.12f, ceiling - 0.22f},
                      {-d + 0.12f, ceiling}}},
                    length, 1, 1),
           start);
}

void add_floors(Model& to, const Palette& palette, float length, bool whole) {
    const float d = gallery_depth, border = 0.40f, w = wall_half;
    append(to[palette.limestone],
           moulding({{{step_edge, -0.05f},
                      {step_edge, 0.13f},
                      {step_edge - 0.02f, 0.15f},
                      {step_edge - 0.33f, 0.15f},
                      {step_edge - 0.33f, ground_floor - 0.02f},
                      {step_edge - 0.35f, ground_floor},
                      {-border, ground_floor}}},
                    length, 1, 1),
           translation({-0.5f * length, 0, 0}));
    const auto lay = [&](const Finish& finish, float half, float y, float from, float to_z, bool faces_up) {
        const float depth = to_z - from;
        append(to[finish], faces_up ? parallelogram({-half, y, to_z}, {2 * half, 0, 0}, {0, 0, -depth})
                                    : parallelogram({-half, y, from}, {2 * half, 0, 0}, {0, 0, depth}));
    };
    const float half = 0.5f * length;
    lay(palette.brick, half + (whole ? d : border), ground_floor, -d, -border, true);
    lay(palette.brick, half + (whole ? d : -w), upper_floor, -d, w, true);
    lay(palette.wood, half + (whole ? d : w), ceiling, -d, -w, false);
    for (const float z : {-0.9f, -1.825f, -2.75f}) {
        const float reach = half + (whole ? d : w);
        append(to[palette.wood],
               box({-reach, ceiling - 0.12f, z - 0.06f}, {reach, ceiling + 0.01f, z + 0.06f}));
    }
}

}  // namespace

Model vault(const Palette& palette, float half_width) {
    const Geometry along = vault_web({half_width, vault_half_depth});
    const Geometry across = vault_web({vault_half_depth, half_width});
    Model model;
    for (int i = 0; i < 4; ++i) {
        append(model[palette.plaster], i % 2 == 0 ? along : across,
               translation({0, ground_spring, vault_center}) * rotation_y(0.5f * pi * float(i)));
    }
    return model;
}

Model vault_rib(const Palette& palette) {
    Model model;
    append(model[palette.limestone],
           archivolt({{{-0.2f, 0.03f}, {-0.2f, -0.09f}, {0.2f, -0.09f}, {0.2f, 0.03f}}},
                     {vault_half_depth, vault_rise}, 12),
           translation({0, ground_spring, vault_center}) * rotation_y(0.5f * pi));
    const float top = ground_spring, foot = ground_floor;
    append(model[palette.limestone],
           prism({{{0.27f, foot},
                   {0.27f, foot + 0.22f},
                   {0.23f, foot + 0.28f},
                   {0.23f, top - 0.13f},
                   {0.28f, top - 0.08f},
                   {0.28f, top},
                   {0, top}}},
                 4),
           translation({0, 0, -gallery_depth - 0.05f}));
    return model;
}

Model door(const Palette& palette) {
    constexpr glm::vec2 opening{1.24f, 2.55f};
    Model model;
    append(model[palette.limestone], opening_frame(opening, 0.2f), on_back_wall(ground_floor));
    for (const float x : {-0.25f * opening.x, 0.25f * opening.x}) {
        append(model[palette.wood], wooden_leaf({0.5f * opening.x - 0.006f, opening.y}, 3),
               on_back_wall(ground_floor) * translation({x, 0, 0}));
        append(model[palette.bronze], sphere(0.035f, 6, 4),
               on_back_wall(ground_floor) * translation({0.2f * x, 1.12f, 0.09f}));
    }
    return model;
}

Model window(const Palette& palette) {
    constexpr glm::vec2 opening{0.96f, 1.70f};
    const glm::mat4 place = on_back_wall(upper_floor + 0.95f);
    Model model;
    append(model[palette.limestone], opening_frame(opening, 0.16f), place);
    append(model[palette.limestone], box({-0.74f, -0.12f, -frame_foot}, {0.74f, 0.0f, 0.2f}), place);
    for (const float x : {-0.25f * opening.x, 0.25f * opening.x}) {
        append(model[palette.wood], wooden_leaf({0.5f * opening.x - 0.006f, opening.y}, 2),
               place * translation({x, 0, 0}));
    }
    return model;
}

Model beams(const Palette& palette) {
    Model model;
    for (const float x : {-1.05f, -0.35f, 0.35f, 1.05f}) {
        append(model[palette.wood], box({x - 0.08f, ceiling - 0.24f, -gallery_depth - 0.03f},
                                        {x + 0.08f, ceiling + 0.02f, -wall_half + 0.03f}));
    }
    return model;
}

Model side_work(const Palette& palette, int index) {
    const float length = side(index).length;
    const bool whole = index % 2 == 0;
    Model model;
    add_floors(model, palette, length, whole);
    add_back_wall(model, palette, length, whole);
    add_cornices(model, palette, length);
    add_roof(model, palette, length);
    return model;
}

}  // namespace lumo::scene::builtin::atrium
