#include "scene/builtin/textures.hpp"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <vector>

namespace lumo::scene::builtin {

namespace {

uint32_t hash(uint32_t x, uint32_t y, uint32_t seed) {
    uint32_t h = x * 0x9E3779B1u ^ y * 0x85EBCA77u ^ seed * 0xC2B2AE3Du;
    h = (h ^ (h >> 15)) * 0x2C1B3C6Du;
    h = (h ^ (h >> 12)) * 0x297A2D39u;
    return h ^ (h >> 15);
}

/// Uniform in [0,1).
float random_value(int x, int y, uint32_t seed) {
    return float(hash(uint32_t(x), uint32_t(y), seed) >> 8) * 0x1p-24f;
}

int wrap(int i, int period) { return ((i % period) + period) % period; }

/// Gradient noise, about -1 to 1, repeating after period cells in each direction.
float noise(glm::vec2 p, glm::ivec2 period, uint32_t seed) {
    const glm::ivec2 cell(glm::floor(p));
    const glm::vec2 f = p - glm::vec2(cell);
    const auto corner = [&](int dx, int dy) {
        constexpr glm::vec2 gradients[8] = {{1, 0},     {-1, 0},     {0, 1},      {0, -1},
                                            {.7f, .7f}, {-.7f, .7f}, {.7f, -.7f}, {-.7f, -.7f}};
        const uint32_t h =
            hash(uint32_t(wrap(cell.x + dx, period.x)), uint32_t(wrap(cell.y + dy, period.y)), seed);
        return glm::dot(gradients[h >> 29], f - glm::vec2(dx, dy));
    };
    const glm::vec2 w = f * f * f * (f * (f * 6.0f - 15.0f) + 10.0f);
    return 1.4f * glm::mix(glm::mix(corner(0, 0), corner(1, 0), w.x),
                           glm::mix(corner(0, 1), corner(1, 1), w.x), w.y);
}

/// Octaves of noise at twice the frequency and half the weight each; frequency is in cells a tile.
float fractal(glm::vec2 p, glm::ivec2 frequency, int octaves, uint32_t seed) {
    float sum = 0, weight = 0.5f;
    for (int i = 0; i < octaves; ++i) {
        sum += weight * noise(p * glm::vec2(frequency), frequency, seed + uint32_t(i));
        frequency *= 2;
        weight *= 0.5f;
    }
    return sum;
}

float smooth(float low, float high, float x) { return glm::smoothstep(low, high, x); }

/// 1 on a line where value is 0, falling to 0 at the width.
float line(float value, float width) { return 1 - smooth(0.35f * width, width, std::abs(value)); }

/// Distance of a position in a rectangle of that size (origin at a corner) to its border.
float border_distance(glm::vec2 p, glm::vec2 size) {
    return std::min(std::min(p.x, size.x - p.x), std::min(p.y, size.y - p.y));
}

/// How much a vein runs here, 0 to 1.
float veins(glm::vec2 p, int frequency, float width, uint32_t seed) {
    const glm::vec2 bent =
        p + 0.12f * glm::vec2(fractal(p, glm::ivec2(3), 4, seed), fractal(p, glm::ivec2(3), 4, seed + 9));
    return line(noise(bent * float(frequency), glm::ivec2(frequency), seed + 17), width);
}

uint8_t to_byte(float value) { return uint8_t(std::lround(255 * std::clamp(value, 0.0f, 1.0f))); }

uint8_t to_srgb_byte(float linear) {
    linear = std::clamp(linear, 0.0f, 1.0f);
    return to_byte(linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1 / 2.4f) - 0.055f);
}

}  // namespace

SurfaceSample limestone(glm::vec2 p) {
    const float beds =
        noise(p * glm::vec2(3, 22) + glm::vec2(0, fractal(p, glm::ivec2(4), 2, 5)), {3, 22}, 1);
    const float stain = fractal(p, glm::ivec2(4), 4, 2);
    const float grain = fractal(p, glm::ivec2(64), 3, 3);
    const float pit = smooth(0.50f, 0.8f, noise(p * 110.0f, glm::ivec2(110), 4) - 0.4f * stain);
    const glm::vec3 base(0.64f, 0.56f, 0.44f);
    return {.albedo = base * (1 + 0.05f * beds + 0.22f * stain + 0.10f * grain) * (1 - 0.25f * pit),
            .height = 0.0007f * grain + 0.001f * stain - 0.0012f * pit,
            .roughness = 0.72f + 0.1f * stain + 0.1f * pit};
}

SurfaceSample ashlar(glm::vec2 p) {
    const float metres = 2.24f;
    const int course = int(p.y * 4);
    const float shift = course % 2 ? 0.25f : 0.0f;
    const float column = (p.x + shift) * 2;
    const int stone = wrap(int(std::floor(column)), 2);
    const glm::vec2 size(0.5f * metres, 0.25f * metres);
    const glm::vec2 in_stone(glm::fract(column) * size.x, glm::fract(p.y * 4) * size.y);
    const float edge = border_distance(in_stone, size) + 0.004f * fractal(p, glm::ivec2(24), 3, 21);
    const float face = smooth(0.004f, 0.018f, edge);
    const float tone = random_value(stone, course, 20);
    const glm::vec2 own =
        glm::fract(p + glm::vec2(random_value(stone, course, 22), random_value(stone, course, 23)));
    SurfaceSample sample = limestone(own);
    sample.albedo *= glm::mix(glm::vec3(0.86f, 0.84f, 0.82f), glm::vec3(1.06f, 1.02f, 0.95f), tone);
    sample.albedo *= glm::mix(0.62f, 1.0f, face);
    const float dressing = fractal(own, glm::ivec2(20), 3, 24);
    sample.height = face * (sample.height + 0.0035f * dressing + 0.002f * tone) - 0.009f * (1 - face);
    sample.roughness = glm::mix(0.95f, sample.roughness + 0.05f, face);
    return sample;
}

SurfaceSample plaster(glm::vec2 p) {
    const float stain = fractal(p, glm::ivec2(3), 5, 31);
    const float trowel = fractal(p + 0.02f * glm::vec2(stain), {9, 14}, 4, 32);
    const float grain = noise(p * 160.0f, glm::ivec2(160), 33);
    const float patch = smooth(0.22f, 0.34f, fractal(p, glm::ivec2(5), 4, 34));
    const glm::vec3 wash = glm::mix(glm::vec3(0.80f, 0.69f, 0.52f), glm::vec3(0.82f, 0.74f, 0.61f), patch);
    return {.albedo = wash * (1 + 0.2f * stain + 0.03f * grain),
            .height = 0.005f * trowel + 0.0006f * grain + 0.0012f * patch,
            .roughness = 0.88f + 0.08f * trowel};
}

SurfaceSample marble(glm::vec2 p) {
    const float cloud = fractal(p, glm::ivec2(3), 5, 41);
    const float vein = std::max(veins(p, 3, 0.16f, 42), 0.6f * veins(p, 7, 0.12f, 43));
    const glm::vec3 ground = glm::vec3(0.74f, 0.72f, 0.68f) * (1 + 0.12f * cloud);
    return {.albedo = glm::mix(ground, glm::vec3(0.42f, 0.42f, 0.43f), 0.55f * vein),
            .height = 0.0004f * cloud,
            .roughness = 0.32f + 0.10f * cloud + 0.06f * vein};
}

SurfaceSample inlay(glm::vec2 p) {
    constexpr float half = 1.4f;  // of the tile
    constexpr float inner =
        half - 0.21f;  // half of the field; the band about it is shared with the next tile
    constexpr float core_half = 0.30f, disc_radius = 0.27f;
    const glm::vec2 q = (p - 0.5f) * 2.0f * half;  // metres from the field's centre
    const glm::vec2 a = glm::abs(q);
    const float to_field = std::max(a.x, a.y) - inner;
    const float to_diamond = (a.x + a.y - inner) * 0.70710678f;
    const float to_core = std::max(a.x, a.y) - core_half;
    const float to_disc = glm::length(a - half) - disc_radius;
    const int right = q.x > 0, up = q.y > 0;

    // Which stone lies here, as which slab, and how far its nearest joint is.
    enum { rosso, cream, slate, white } stone;
    int slab;
    float joint = std::min(std::abs(to_field), std::abs(to_disc));
    if (to_disc < 0) {
        stone = white;
        slab = 0;
    } else if (to_field > 0) {
        stone = rosso;
        slab = a.x > a.y ? 1 + up : 3 + right;
        joint = std::min({joint, a.x, a.y});
    } else if (to_core < 0) {
        stone = rosso;
        slab = 5;
        joint = std::min(joint, -to_core);
    } else if (to_diamond > 0) {
        stone = slate;
        slab = 6 + right + 2 * up;
        joint = std::min(joint, to_diamond);
    } else {
        stone = cream;
        slab = 10 + right + 2 * up;
        joint = std::min({joint, -to_diamond, to_core, a.x, a.y});
    }

    // Each slab is cut from another place of its marble.
    const glm::vec2 cut = p + glm::vec2(random_value(slab, 0, 54), random_value(slab, 1, 54));
    const float vein = veins(cut, 5, 0.14f, 52);
    const float cloud = fractal(cut, glm::ivec2(9), 4, 53);
    const float wear = fractal(p, glm::ivec2(4), 5, 51);
    SurfaceSample sample;
    switch (stone) {
        case rosso:
            sample.albedo = glm::mix(glm::vec3(0.38f, 0.14f, 0.09f) * (1 + 0.3f * cloud),
                                     glm::vec3(0.55f, 0.33f, 0.25f), 0.5f * vein);
            sample.roughness = 0.27f;
            break;
        case cream:
            sample.albedo = glm::vec3(0.66f, 0.58f, 0.46f) * (1 + 0.25f * cloud) * (1 - 0.15f * vein);
            sample.roughness = 0.38f;
            break;
        case slate:
            sample.albedo = glm::vec3(0.25f, 0.27f, 0.27f) * (1 + 0.45f * cloud) + 0.09f * vein;
            sample.roughness = 0.34f;
            break;
        case white:
            sample.albedo = glm::vec3(0.72f, 0.69f, 0.63f) * (1 + 0.12f * cloud) * (1 - 0.2f * vein);
            sample.roughness = 0.30f;
            break;
    }
    const float face = smooth(0.003f, 0.009f, joint);
    sample.albedo *= (0.94f + 0.12f * random_value(slab, 2, 54)) * glm::mix(0.55f, 1 + 0.14f * wear, face);
    sample.height = face * 0.0012f * (1 + wear) + 0.0004f * cloud;
    sample.roughness = glm::mix(0.9f, sample.roughness + 0.28f * smooth(-0.25f, 0.35f, wear), face);
    return sample;
}

SurfaceSample brick_floor(glm::vec2 p) {
    // A herringbone of bricks 1 by 2 repeats after 4 cells; 8 cells of 0.14 m make a tile.
    const glm::vec2 q = p * 8.0f;
    const glm::ivec2 cell(glm::floor(q));
    const int phase = wrap(cell.x - cell.y, 4);
    const bool lies = phase < 2;
    const glm::ivec2 origin = lies ? cell - glm::ivec2(phase, 0) : cell - glm::ivec2(0, phase == 2 ? 1 : 0);
    const glm::vec2 size = lies ? glm::vec2(2, 1) : glm::vec2(1, 2);
    const float edge =
        border_distance(q - glm::vec2(origin), size) + 0.02f * fractal(p, glm::ivec2(40), 2, 61);
    const float face = smooth(0.03f, 0.10f, edge);
    const float tone = random_value(wrap(origin.x, 8), wrap(origin.y, 8), 62);
    const float soil = fractal(p, glm::ivec2(6), 4, 63);
    const glm::vec3 brick = glm::mix(glm::vec3(0.43f, 0.20f, 0.115f), glm::vec3(0.60f, 0.36f, 0.225f), tone);
    return {.albedo = glm::mix(glm::vec3(0.36f, 0.31f, 0.25f), brick * (1 + 0.2f * soil), face),
            .height = face * (0.003f + 0.002f * tone) + 0.0008f * soil,
            .roughness = glm::mix(0.95f, 0.55f + 0.2f * soil + 0.15f * tone, face)};
}

SurfaceSample clay(glm::vec2 p) {
    const float bloom = fractal(p, glm::ivec2(5), 5, 71);
    const float grain = noise(p * 90.0f, glm::ivec2(90), 72);
    const glm::vec3 base =
        glm::mix(glm::vec3(0.46f, 0.20f, 0.11f), glm::vec3(0.60f, 0.40f, 0.29f), smooth(-0.1f, 0.5f, bloom));
    return {.albedo = base * (1 + 0.12f * bloom + 0.05f * grain),
            .height = 0.0015f * bloom + 0.0005f * grain,
            .roughness = 0.82f + 0.1f * bloom};
}

SurfaceSample planks(glm::vec2 p) {
    const int board = int(p.x * 4);
    const float across = glm::fract(p.x * 4);
    const float own = random_value(board, 0, 81);
    const glm::vec2 q(p.x, glm::fract(p.y + own));
    const float bend = fractal(q, {4, 2}, 3, 82);
    const float rings = noise(glm::vec2(q.x * 40 + 3 * bend, q.y * 2), {40, 2}, 83);
    const float fibre = fractal(q, {90, 5}, 3, 84);
    const float gap = 1 - smooth(0.01f, 0.035f, std::min(across, 1 - across));
    const glm::vec3 wood =
        glm::mix(glm::vec3(0.20f, 0.10f, 0.05f), glm::vec3(0.33f, 0.19f, 0.10f), 0.5f + 0.5f * rings);
    return {.albedo = wood * (0.85f + 0.3f * own + 0.35f * fibre) * (1 - 0.75f * gap),
            .height = 0.0012f * fibre + 0.0008f * rings - 0.006f * gap,
            .roughness = 0.6f + 0.15f * fibre + 0.2f * gap};
}

SurfaceSample damask(glm::vec2 p) {
    const float tau = glm::two_pi<float>();
    // A half-drop repeat: ogees with a palmette in each, mirrored left and right as a loom does.
    const auto figure_at = [&](glm::vec2 c) {
        const glm::vec2 q(std::abs(glm::fract(c.x) - 0.5f), glm::fract(c.y) - 0.5f);
        const float ogee = q.x - 0.25f * (1 + std::cos(tau * q.y)) * (1 - 0.12f * std::cos(2 * tau * q.y));
        const float leaves = std::cos(7 * std::atan2(q.x, q.y + 0.12f)) * 0.035f;
        const float palmette = glm::length(glm::vec2(1.5f * q.x, q.y + 0.02f)) - 0.21f - leaves;
        const float heart = glm::length(glm::vec2(q.x, q.y - 0.02f)) - 0.06f;
        return std::max(
            {line(ogee + 0.03f, 0.035f), smooth(0.012f, -0.012f, palmette) - smooth(0.012f, -0.012f, heart)});
    };
    const float figure = std::clamp(figure_at(p * glm::vec2(2, 1)), 0.0f, 1.0f);
    const glm::vec2 thread = p * 96.0f;
    const bool over = (int(thread.x) + int(thread.y)) % 2;
    const glm::vec2 round = glm::sin(glm::fract(thread) * glm::pi<float>());
    const float weave = over ? round.x : round.y;
    const float slub = noise(p * glm::vec2(6, 96), {6, 96}, 91);
    return {.albedo = glm::vec3(glm::mix(0.74f, 0.97f, figure) * (0.86f + 0.12f * weave + 0.05f * slub)),
            .height = 0.0007f * weave + 0.0006f * figure,
            .roughness = glm::mix(0.88f, 0.60f, figure)};
}

uint32_t add_surface_material(Scene& scene, const SurfaceMaterial& surface) {
    const uint32_t side = surface.side;
    std::vector<SurfaceSample> samples(size_t(side) * side);
    for (uint32_t row = 0; row < side; ++row) {
        for (uint32_t column = 0; column < side; ++column) {
            const glm::vec2 center(float(column) + 0.5f, float(side - 1 - row) + 0.5f);
            samples[size_t(row) * side + column] = surface.pattern(center / float(side));
        }
    }
    const auto height = [&](uint32_t column, uint32_t row) {
        return samples[size_t(row % side) * side + column % side].height;
    };

    Image8 color{side, side, 4, std::vector<uint8_t>(samples.size() * 4)};
    Image8 metallic_roughness = color, normal = color;
    const float two_texels = 2 * surface.metres_per_tile / float(side);
    for (uint32_t row = 0; row < side; ++row) {
        for (uint32_t column = 0; column < side; ++column) {
            const SurfaceSample& sample = samples[size_t(row) * side + column];
            uint8_t* c = color.at(column, row);
            for (int i = 0; i < 3; ++i) c[i] = to_srgb_byte(sample.albedo[i]);
            c[3] = 255;
            uint8_t* m = metallic_roughness.at(column, row);
            m[0] = 255;
            m[1] = to_byte(sample.roughness);
            m[2] = 0;
            m[3] = 255;
            const float right = height(column + 1, row) - height(column + side - 1, row);
            const float up = height(column, row + side - 1) - height(column, row + 1);
            const glm::vec3 n = glm::normalize(glm::vec3(-right, -up, two_texels));
            uint8_t* out = normal.at(column, row);
            for (int i = 0; i < 3; ++i) out[i] = to_byte(0.5f + 0.5f * n[i]);
            out[3] = 255;
        }
    }

    const auto add_texture = [&](Image8 image) {
        scene.images.push_back(std::move(image));
        scene.textures.push_back({.image = uint32_t(scene.images.size() - 1), .sampler = {}});
        return TextureSlot{.texture = uint32_t(scene.textures.size() - 1)};
    };
    Material material{.name = surface.name, .metallic = 0};
    material.base_color_texture = add_texture(std::move(color));
    material.metallic_roughness_texture = add_texture(std::move(metallic_roughness));
    material.normal_texture = add_texture(std::move(normal));
    scene.materials.push_back(std::move(material));
    return uint32_t(scene.materials.size() - 1);
}

uint32_t add_tinted_material(Scene& scene, const char* name, uint32_t like, glm::vec3 tint) {
    Material material = scene.materials[like];
    material.name = name;
    material.base_color = glm::vec4(tint, 1);
    scene.materials.push_back(std::move(material));
    return uint32_t(scene.materials.size() - 1);
}

}  // namespace lumo::scene::builtin
