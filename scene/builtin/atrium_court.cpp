#include <cmath>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <random>

#include "scene/builtin/atrium.hpp"

namespace lumo::scene::builtin::atrium {

namespace {

constexpr float pi = glm::pi<float>();

/// Points spread evenly over a sphere (a Fibonacci lattice).
glm::vec3 sphere_point(int i, int count) {
    const float y = 1 - 2 * (float(i) + 0.5f) / float(count);
    const float angle = 2.39996323f * float(i);
    const float r = std::sqrt(1 - y * y);
    return {r * std::cos(angle), y, r * std::sin(angle)};
}

/// A leaf bent along its rib, in the XZ plane, from its stalk at the origin to its tip at +Z.
Geometry leaf(float length) {
    const float half = 0.26f * length, lift = 0.10f * length;
    return quadrilateral({0, 0, 0}, {half, lift, 0.45f * length}, {0, 0, length},
                         {-half, lift, 0.45f * length});
}

/// A disc facing up.
Geometry disc(float radius, float height, uint32_t segments) {
    return lathe({{{radius, height}, {0, height}}}, segments);
}

}  // namespace

Model court_floor(const Palette& palette) {
    const glm::vec2 inner = half_axes - paving_edge, outer = half_axes - step_edge + 0.02f;
    Model model;
    append(model[palette.inlay],
           parallelogram({-inner.x, 0, inner.y}, {2 * inner.x, 0, 0}, {0, 0, -2 * inner.y}));
    Geometry border;
    const glm::vec3 in[4] = {
        {-inner.x, 0, inner.y}, {inner.x, 0, inner.y}, {inner.x, 0, -inner.y}, {-inner.x, 0, -inner.y}};
    const glm::vec3 out[4] = {
        {-outer.x, 0, outer.y}, {outer.x, 0, outer.y}, {outer.x, 0, -outer.y}, {-outer.x, 0, -outer.y}};
    for (int i = 0; i < 4; ++i) {
        append(border, quadrilateral(out[i], out[(i + 1) % 4], in[(i + 1) % 4], in[i]));
    }
    append(model[palette.marble], border);
    return model;
}

Model fountain(const Palette& palette) {
    Model model;
    Geometry stone = prism({{{2.25f, 0}, {2.25f, 0.13f}, {2.23f, 0.15f}, {1.5f, 0.15f}}}, 8);
    append(stone, prism({{{1.92f, 0.15f},
                          {1.92f, 0.25f},
                          {1.86f, 0.31f},
                          {1.80f, 0.33f},
                          {1.80f, 0.62f},
                          {1.84f, 0.66f},
                          {1.91f, 0.71f},
                          {1.91f, 0.78f},
                          {1.88f, 0.81f},
                          {1.62f, 0.81f},
                          {1.59f, 0.78f},
                          {1.59f, 0.30f}}},
                        8));
    append(model[palette.limestone], stone);
    append(model[palette.water], prism({{{1.62f, 0.64f}, {0, 0.64f}}}, 8));
    // The panels between the basin's corner posts.
    for (int i = 0; i < 8; ++i) {
        const glm::mat4 turn = rotation_y(0.25f * pi * (float(i) + 0.5f));
        append(model[palette.marble], box({-0.11f, 0.30f, -0.12f}, {0.11f, 0.68f, 0.06f}),
               turn * translation({0, 0, 1.92f}));
        append(model[palette.rosso], box({-0.46f, 0.40f, -0.05f}, {0.46f, 0.56f, 0.018f}),
               rotation_y(0.25f * pi * float(i)) * translation({0, 0, 1.80f}));
    }

    Profile stem{{{0.42f, 0.3f},  {0.42f, 0.70f}, {0.36f, 0.76f}, {0.24f, 0.80f}, {0.17f, 0.90f},
                  {0.16f, 0.98f}, {0.24f, 1.12f}, {0.27f, 1.22f}, {0.22f, 1.34f}, {0.13f, 1.44f},
                  {0.13f, 1.50f}, {0.20f, 1.55f}, {0.42f, 1.60f}, {0.66f, 1.68f}, {0.84f, 1.80f},
                  {0.90f, 1.90f}, {0.94f, 1.92f}, {0.94f, 1.96f}, {0.86f, 1.96f}, {0.80f, 1.86f},
                  {0.6f, 1.76f},  {0.3f, 1.72f}}};
    append(model[palette.marble], lathe(stem, 32));
    append(model[palette.water], disc(0.85f, 1.90f, 32));
    Profile finial{{{0.16f, 1.7f},
                    {0.16f, 1.98f},
                    {0.10f, 2.04f},
                    {0.07f, 2.16f},
                    {0.10f, 2.26f},
                    {0.17f, 2.30f},
                    {0.17f, 2.33f},
                    {0.10f, 2.36f}}};
    append(model[palette.bronze], lathe(finial, 20));
    // A pine cone, its scales in spirals.
    const float cone_foot = 2.34f, cone_height = 0.42f;
    Geometry cone = lathe({{{0.10f, cone_foot},
                            {0.135f, cone_foot + 0.10f},
                            {0.12f, cone_foot + 0.22f},
                            {0.07f, cone_foot + 0.34f},
                            {0, cone_foot + cone_height - 0.02f}}},
                          16);
    constexpr int scales = 70;
    for (int i = 0; i < scales; ++i) {
        const float t = (float(i) + 0.5f) / scales;
        const float radius = 0.14f * std::sin(pi * std::pow(0.18f + 0.80f * t, 0.75f)) + 0.01f;
        const float angle = 2.39996323f * float(i);
        const float size = 0.042f * (1.1f - 0.6f * t);
        const glm::mat4 place =
            rotation_y(angle) *
            translation({0, cone_foot + 0.02f + (cone_height - 0.05f) * t, radius - 0.01f});
        append(cone,
               block({{{-size, -size, -0.02f},
                       {size, -size, -0.02f},
                       {size, size, -0.03f},
                       {-size, size, -0.03f}}},
                     {{{-0.3f * size, 0, 0.02f},
                       {0.3f * size, 0, 0.02f},
                       {0.3f * size, 0.7f * size, 0.012f},
                       {-0.3f * size, 0.7f * size, 0.012f}}}),
               place);
    }
    append(model[palette.bronze], cone);
    return model;
}

Model lemon_tree(const Palette& palette) {
    Model model;
    append(model[palette.clay], lathe({{{0.24f, 0},
                                        {0.26f, 0.04f},
                                        {0.33f, 0.42f},
                                        {0.35f, 0.44f},
                                        {0.35f, 0.49f},
                                        {0.34f, 0.50f},
                                        {0.38f, 0.62f},
                                        {0.42f, 0.65f},
                                        {0.42f, 0.71f},
                                        {0.36f, 0.71f},
                                        {0.34f, 0.60f}}},
                                      16));
    append(model[palette.soil], disc(0.355f, 0.655f, 16));
    append(model[palette.wood], lathe({{{0.05f, 0.6f}, {0.035f, 0.9f}, {0.03f, 1.5f}, {0.0f, 1.9f}}}, 8));

    const glm::vec3 center(0, 1.88f, 0), radii(0.60f, 0.52f, 0.60f);
    std::minstd_rand random(7);
    const auto uniform = [&] { return float(random() - random.min()) / float(random.max() - random.min()); };
    constexpr int leaves = 380;
    const Geometry blade = leaf(0.155f);
    for (int i = 0; i < leaves; ++i) {
        const glm::vec3 n = sphere_point(i, leaves);
        const float depth = 1 - 0.35f * uniform() * uniform();
        // Leaves lie like shingles, tips outward and a little down.
        const glm::vec3 tip = glm::normalize(glm::vec3(uniform(), uniform(), uniform()) -
                                             glm::vec3(0.5f, 0.75f, 0.5f) + 0.45f * n);
        const glm::vec3 side_axis = glm::normalize(glm::cross(n + glm::vec3(0, 0.01f, 0), tip));
        const glm::vec3 face = glm::cross(tip, side_axis);
        const float shade = 0.75f + 0.5f * uniform();
        Geometry placed;
        append(placed, blade,
               glm::mat4(glm::vec4(side_axis, 0), glm::vec4(face, 0), glm::vec4(tip, 0),
                         glm::vec4(center + radii * n * depth, 1)));
        for (Vertex& vertex : placed.vertices)
            vertex.color = glm::vec4(glm::vec3(shade, shade, 0.9f * shade), 1);
        append(model[palette.leaf], placed);
    }
    append(
        model[palette.leaf],
        lathe(
            {{{0.02f, 1.50f}, {0.30f, 1.58f}, {0.44f, 1.80f}, {0.42f, 2.02f}, {0.26f, 2.22f}, {0.0f, 2.28f}},
             1.2f},
            10));
    constexpr int fruits = 9;
    for (int i = 0; i < fruits; ++i) {
        const glm::vec3 n = sphere_point(i, fruits);
        append(model[palette.fruit], sphere(0.048f, 6, 4),
               translation(center + radii * n * 0.98f - glm::vec3(0, 0.04f, 0)));
    }
    return model;
}

}  // namespace lumo::scene::builtin::atrium
