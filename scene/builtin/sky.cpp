// A paved place under an open sky, as wide as its voxels can resolve what stands on it; beyond it lies the planet's
// ground.
#include "scene/sky.hpp"

#include <array>

#include "scene/builtin/geometry.hpp"
#include "scene/builtin/scenes.hpp"

namespace lumo::scene::builtin {

namespace {

constexpr float place_radius = 60;  // metres

/// A block that tapers to a pyramid at its top.
Model obelisk(const Finish& stone, float half_width, float height) {
    const auto corners = [](float half, float y) {
        return std::array<glm::vec3, 4>{glm::vec3(-half, y, half), glm::vec3(half, y, half),
                                        glm::vec3(half, y, -half), glm::vec3(-half, y, -half)};
    };
    const float shoulder = 0.7f * half_width, tip = height - 1.2f * shoulder;
    Model model;
    append(model[stone], block(corners(half_width, 0), corners(shoulder, tip)));
    append(model[stone], block(corners(shoulder, tip), corners(0.02f * half_width, height)));
    return model;
}

/// Two posts and what lies over them.
Model gate(const Finish& stone) {
    Model model;
    append(model[stone], box({-2.4f, 0, -0.6f}, {-1.3f, 4, 0.6f}));
    append(model[stone], box({1.3f, 0, -0.6f}, {2.4f, 4, 0.6f}));
    append(model[stone], box({-2.9f, 4, -0.7f}, {2.9f, 5, 0.7f}));
    return model;
}

}  // namespace

Scene make_sky() {
    Scene scene;
    const Sky sky{.direction_to_sun = glm::normalize(glm::vec3(-0.62f, 0.55f, -0.56f))};
    const Finish paving{add_diffuse_material(scene, "paving", glm::vec3(0.32f, 0.31f, 0.29f))};
    const Finish white{add_diffuse_material(scene, "white", glm::vec3(0.8f))};
    const Finish stone{add_diffuse_material(scene, "stone", glm::vec3(0.45f, 0.42f, 0.38f))};
    const Finish steel{add_diffuse_material(scene, "steel", glm::vec3(0.75f))};
    scene.materials[steel.material].metallic = 1;
    scene.materials[steel.material].roughness = 0.15f;

    Model ground;
    append(ground[paving], lathe({.points = {{place_radius, 0}, {0, 0}}}, 64));
    Model white_ball, steel_ball;
    append(white_ball[white], sphere(2, 48, 24));
    append(steel_ball[steel], sphere(2, 48, 24));
    const auto place = [&](const char* name, const Model& model, const glm::mat4& placement) {
        scene.instances.push_back({.mesh = add_mesh(scene, name, model), .world_from_object = placement});
    };
    place("ground", ground, glm::mat4(1));
    place("white ball", white_ball, translation({-3.4f, 2, -6}));
    place("steel ball", steel_ball, translation({1.6f, 2, -9}));
    place("gate", gate(stone), translation({9, 0, -17}) * rotation_y(-0.5f));
    place("obelisk", obelisk(stone, 1.1f, 15), translation({-15, 0, -30}) * rotation_y(0.35f));
    place("small obelisk", obelisk(white, 0.6f, 7), translation({22, 0, -42}) * rotation_y(0.8f));

    // From eye height, from an airliner toward the horizon, and from orbit toward the limb, 3.2 and 19.8 degrees below
    // the horizontal.
    scene.cameras = {
        {.name = "ground",
         .position = {0, 1.7f, 6},
         .target = {0, 3.6f, -20},
         .vertical_fov = 1.0f,
         .far_plane = 200},
        {.name = "air",
         .position = {0, 10e3f, 0},
         .target = {0, 9e3f, -20e3f},
         .vertical_fov = 0.8f,
         .near_plane = 10,
         .far_plane = 20e3f},
        {.name = "orbit",
         .position = {0, 400e3f, 0},
         .target = {0, 36e3f, -1000e3f},
         .vertical_fov = 0.6f,
         .near_plane = 1e3f,
         .far_plane = 500e3f},
    };
    set_sky(scene, sky);
    return scene;
}

}  // namespace lumo::scene::builtin
