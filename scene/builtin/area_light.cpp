// The paper's HDR case: walls of one colour each and a sphere that emits ten times what eight bits hold.
#include "scene/builtin/geometry.hpp"
#include "scene/builtin/scenes.hpp"

namespace lumo::scene::builtin {

namespace {

constexpr glm::vec3 half_size{3, 2, 2.5f};  // of the room, whose floor is at y = 0
constexpr glm::vec3 sphere_center{0.5f, 1.4f, -0.3f};
constexpr float sphere_radius = 0.45f;

/// A room open to +Z with a wall of each albedo at its left (-X) and right (+X), the rest grey.
Scene make_room(glm::vec3 left_albedo, glm::vec3 right_albedo) {
    Scene scene;
    const Finish grey{add_diffuse_material(scene, "grey", glm::vec3(0.6f))};
    const Finish left{add_diffuse_material(scene, "red", left_albedo)};
    const Finish right{add_diffuse_material(scene, "green", right_albedo)};
    const Finish emitter{add_diffuse_material(scene, "emitter", glm::vec3(0))};
    scene.materials[emitter.material].emission = {0, 0, 10};

    const float x = half_size.x, top = 2 * half_size.y, z = half_size.z;
    Model room;
    append(room[grey], parallelogram({-x, 0, z}, {2 * x, 0, 0}, {0, 0, -2 * z}));
    append(room[grey], parallelogram({-x, top, -z}, {2 * x, 0, 0}, {0, 0, 2 * z}));
    append(room[grey], parallelogram({-x, 0, -z}, {2 * x, 0, 0}, {0, top, 0}));
    append(room[left], parallelogram({-x, 0, z}, {0, 0, -2 * z}, {0, top, 0}));
    append(room[right], parallelogram({x, 0, -z}, {0, 0, 2 * z}, {0, top, 0}));
    Model lamp;
    append(lamp[emitter], sphere(sphere_radius, 32, 16));

    scene.instances.push_back({.mesh = add_mesh(scene, "room", room)});
    scene.instances.push_back(
        {.mesh = add_mesh(scene, "sphere", lamp), .world_from_object = translation(sphere_center)});
    scene.cameras.push_back({.name = "front",
                             .position = {0, half_size.y, 8.2f},
                             .target = {0, half_size.y, 0},
                             .vertical_fov = 0.72f,
                             .far_plane = 100});
    return scene;
}

}  // namespace

Scene make_area_light() { return make_room({0.8f, 0.12f, 0.2f}, {0.12f, 0.8f, 0.2f}); }

Scene make_area_light_pure() { return make_room({1, 0, 0}, {0, 1, 0}); }

}  // namespace lumo::scene::builtin
