#include "scene/builtin/atrium.hpp"

#include <cmath>
#include <glm/gtc/constants.hpp>
#include <initializer_list>
#include <map>

#include "scene/builtin/scenes.hpp"
#include "scene/builtin/textures.hpp"

namespace lumo::scene::builtin {

namespace atrium {

Palette add_palette(Scene& scene) {
    const auto surface = [&](const char* name, SurfacePattern pattern, float metres) {
        return Finish{
            add_surface_material(scene, {.name = name, .pattern = pattern, .metres_per_tile = metres}),
            metres};
    };
    const auto tinted = [&](const char* name, const Finish& like, glm::vec3 tint) {
        return Finish{add_tinted_material(scene, name, like.material, tint), like.metres_per_tile};
    };
    const auto plain = [&](const char* name, glm::vec3 albedo, float roughness) {
        const Finish finish{add_diffuse_material(scene, name, albedo)};
        scene.materials[finish.material].roughness = roughness;
        return finish;
    };
    Palette palette;
    palette.limestone = surface("limestone", limestone, 2);
    palette.ashlar = surface("ashlar", ashlar, 2.24f);
    palette.rosso = tinted("rosso", palette.limestone, {0.80f, 0.45f, 0.36f});
    palette.plaster = surface("plaster", plaster, 3);
    palette.rose_plaster = tinted("rose plaster", palette.plaster, {1.0f, 0.80f, 0.66f});
    palette.marble = surface("marble", marble, 1.5f);
    palette.inlay = surface("inlaid paving", inlay, 2.8f);
    palette.brick = surface("brick floor", brick_floor, 1.12f);
    palette.clay = surface("terracotta", clay, 1);
    palette.wood = surface("wood", planks, 1);
    palette.glaze = plain("blue glaze", {0.03f, 0.10f, 0.36f}, 0.25f);
    palette.bronze = plain("bronze", {0.55f, 0.38f, 0.20f}, 0.38f);
    scene.materials[palette.bronze.material].metallic = 1;
    palette.water = plain("water", {0.03f, 0.07f, 0.07f}, 0.06f);
    palette.leaf = plain("leaves", {0.055f, 0.14f, 0.025f}, 0.55f);
    scene.materials[palette.leaf.material].double_sided = true;
    palette.fruit = plain("lemons", {0.85f, 0.55f, 0.04f}, 0.5f);
    palette.soil = plain("soil", {0.08f, 0.055f, 0.04f}, 1);

    const Finish linen = surface("linen", damask, 0.7f);
    scene.materials[linen.material].double_sided = true;
    palette.cloth = {tinted("red cloth", linen, {0.60f, 0.045f, 0.035f}),
                     tinted("green cloth", linen, {0.05f, 0.30f, 0.10f}),
                     tinted("blue cloth", linen, {0.04f, 0.11f, 0.46f}),
                     tinted("ochre cloth", linen, {0.80f, 0.46f, 0.09f}), linen};
    return palette;
}

Side side(int index) {
    const bool is_long = index % 2 == 0;
    const int bays = is_long ? long_bays : short_bays;
    const float distance = is_long ? half_axes.y : half_axes.x;
    return {.length = bay_width * float(bays),
            .bays = bays,
            .placement = rotation_y(0.5f * glm::pi<float>() * float(index)) * translation({0, 0, -distance})};
}

namespace {

/// The architecture: what is repeated in every bay and along every side.
void add_building(Scene& scene, const Palette& palette) {
    const auto add = [&](const char* name, const Model& model) { return add_mesh(scene, name, model); };
    const uint32_t bay_meshes[] = {
        add("ground arch", ground_arch(palette)),
        add("upper arch", upper_arch(palette)),
        add("balustrade", balustrade(palette)),
        add("vault", vault(palette, 0.5f * bay_width)),
        add("beams", beams(palette)),
    };
    const uint32_t axis_meshes[] = {
        add("ground column", ground_column(palette)),
        add("upper column", upper_column(palette)),
        add("roundel", roundel(palette)),
        add("vault rib", vault_rib(palette)),
    };
    const uint32_t rib = axis_meshes[3], beam = bay_meshes[4];
    const float corner_half = 0.5f * (gallery_depth - wall_half);
    const uint32_t corner_vault = add("corner vault", vault(palette, corner_half));
    const uint32_t pier = add("corner pier", corner_pier(palette));
    const uint32_t doorway = add("door", door(palette)), shutters = add("window", window(palette));

    for (int index = 0; index < 4; ++index) {
        const Side s = side(index);
        const auto place = [&](uint32_t mesh, float x, float z = 0) {
            scene.instances.push_back(
                {.mesh = mesh, .world_from_object = s.placement * translation({x, 0, z})});
        };
        place(add(index % 2 == 0 ? "long side" : "short side", side_work(palette, index)), 0);
        for (int i = 0; i < s.bays; ++i) {
            const float x = bay_width * (float(i) - 0.5f * float(s.bays - 1));
            for (const uint32_t mesh : bay_meshes) place(mesh, x);
            place(i % 2 == 0 ? shutters : doorway, x);
            if (i > 0) {
                for (const uint32_t mesh : axis_meshes) place(mesh, x - 0.5f * bay_width);
            }
        }
        const float corner = 0.5f * s.length;
        place(pier, corner);
        place(rib, -corner - 0.5f * wall_half);
        place(rib, corner + 0.5f * wall_half);
        if (index % 2 == 0) {
            for (const float x : {-corner - wall_half - corner_half, corner + wall_half + corner_half}) {
                place(corner_vault, x);
                place(beam, x);
            }
        }
    }
}

void add_court(Scene& scene, const Palette& palette) {
    const auto place = [&](uint32_t mesh, const glm::mat4& placement) {
        scene.instances.push_back({.mesh = mesh, .world_from_object = placement});
    };
    place(add_mesh(scene, "court floor", court_floor(palette)), glm::mat4(1));
    place(add_mesh(scene, "fountain", fountain(palette)), glm::mat4(1));
    const uint32_t tree = add_mesh(scene, "lemon tree", lemon_tree(palette));
    for (const float x : {-9.7f, 9.7f}) {
        for (const float z : {-4.1f, 4.1f}) {
            place(tree, translation({x, 0, z}) * rotation_y(x + 2 * z));
        }
    }
}

void add_cloth(Scene& scene, const Palette& palette) {
    enum Color { red, green, blue, ochre, linen };
    struct Hanging {
        int side, bay;
        Color color;
    };
    const auto hang = [&](const char* name, auto make_model, std::initializer_list<Hanging> places) {
        std::map<Color, uint32_t> meshes;
        for (const Hanging& place : places) {
            if (!meshes.contains(place.color)) {
                meshes[place.color] = add_mesh(scene, name, make_model(place.color));
            }
            const Side s = side(place.side);
            const float x = bay_width * (float(place.bay) - 0.5f * float(s.bays - 1));
            scene.instances.push_back(
                {.mesh = meshes[place.color], .world_from_object = s.placement * translation({x, 0, 0})});
        }
    };
    hang("drawn curtain", [&](Color color) { return drawn_curtain(palette.cloth[color], palette); },
         {{0, 1, red}, {0, 5, green}, {1, 1, blue}, {2, 2, ochre}, {3, 1, linen}});
    hang("tied curtain", [&](Color color) { return tied_curtain(palette.cloth[color], palette); },
         {{0, 3, blue}, {0, 7, ochre}, {1, 3, red}, {3, 2, green}, {2, 6, red}});
    hang("banner",
         [&](Color color) {
             return banner(palette.cloth[color], palette.cloth[color == ochre ? red : ochre]);
         },
         {{0, 0, ochre},
          {0, 2, green},
          {0, 4, red},
          {0, 6, blue},
          {0, 8, ochre},
          {1, 2, red},
          {3, 1, blue},
          {3, 3, ochre},
          {2, 1, red},
          {2, 4, blue},
          {2, 7, green}});
}

}  // namespace

}  // namespace atrium

Scene make_atrium() {
    Scene scene;
    const atrium::Palette palette = atrium::add_palette(scene);
    atrium::add_building(scene, palette);
    atrium::add_court(scene, palette);
    atrium::add_cloth(scene, palette);

    // Late morning: the sun comes over the roof at one's right, onto the floor and the far arcade.
    const glm::vec3 to_sun = glm::normalize(glm::vec3(-0.36f, 1, 0.38f));
    scene.lights.push_back({.name = "sun",
                            .kind = LightKind::directional,
                            .intensity = {7.6f, 6.7f, 5.3f},
                            .direction = -to_sun});
    scene.environment_radiance = {0.32f, 0.43f, 0.60f};
    scene.cameras = {
        {.name = "court",
         .position = {-8.3f, 1.7f, 5.0f},
         .target = {0.6f, 3.35f, -1.8f},
         .vertical_fov = 1.05f,
         .far_plane = 100},
        {.name = "gallery",
         .position = {-7.3f, 1.75f, -9.3f},
         .target = {2.4f, 2.3f, -8.3f},
         .vertical_fov = 1.0f,
         .far_plane = 100},
        {.name = "balcony",
         .position = {12.45f, 7.6f, 2.9f},
         .target = {-2, 3.4f, -1.4f},
         .vertical_fov = 1.05f,
         .far_plane = 100},
        {.name = "fountain",
         .position = {4.6f, 1.5f, 3.6f},
         .target = {-1.4f, 2.6f, -2.0f},
         .vertical_fov = 0.95f,
         .far_plane = 100},
    };
    return scene;
}

}  // namespace lumo::scene::builtin
