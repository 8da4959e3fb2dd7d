// The white furnace. A convex body sees nothing of itself, so the irradiance of its environment is pi
// everywhere; flat faces keep that exact for shading normals too.
#include "scene/builtin/geometry.hpp"
#include "scene/builtin/scenes.hpp"

namespace lumo::scene::builtin {

Scene make_furnace() {
    Scene scene;
    const Finish white{add_diffuse_material(scene, "white", glm::vec3(1))};
    Model body;
    append(body[white], faceted_sphere(1, 48, 24));
    scene.instances.push_back({.mesh = add_mesh(scene, "body", body)});
    scene.environment_radiance = glm::vec3(1);
    scene.cameras.push_back({.name = "front",
                             .position = {0, 0, 4},
                             .target = {0, 0, 0},
                             .vertical_fov = 0.7f,
                             .far_plane = 100});
    return scene;
}

}  // namespace lumo::scene::builtin
