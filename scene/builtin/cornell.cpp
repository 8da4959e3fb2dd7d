// Geometry, camera and Lambertian surfaces as published by Cornell University's Program of Computer Graphics
// ("Cornell Box Data"), whose millimetres become centimetres here, so that the box is 5.5 m wide. The
// measured spectra as linear Rec. 709 are the customary triples of McGuire's Computer Graphics Archive.
#include <array>
#include <cmath>

#include "scene/builtin/geometry.hpp"
#include "scene/builtin/scenes.hpp"

namespace lumo::scene::builtin {

namespace {

constexpr float scale = 0.01f;
constexpr glm::vec3 white{0.725f, 0.71f, 0.68f};
constexpr glm::vec3 red{0.63f, 0.065f, 0.05f};
constexpr glm::vec3 green{0.14f, 0.45f, 0.091f};
constexpr glm::vec3 lamp_radiance{17, 12, 4};

/// A face, its corners in the publication's order, which is counter-clockwise.
Geometry face(glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 d) {
    return quadrilateral(scale * a, scale * b, scale * c, scale * d);
}

/// The ceiling is a frame about the lamp, which fills the hole in the same plane.
Geometry ceiling_around(const std::array<glm::vec3, 4>& lamp) {
    const std::array<glm::vec3, 4> outer{glm::vec3(556, 548.8f, 0), glm::vec3(556, 548.8f, 559.2f),
                                         glm::vec3(0, 548.8f, 559.2f), glm::vec3(0, 548.8f, 0)};
    Geometry result;
    for (size_t i = 0; i < 4; ++i) {
        const size_t next = (i + 1) % 4;
        append(result, face(outer[i], outer[next], lamp[next], lamp[i]));
    }
    return result;
}

/// Top and sides over a plan in x and z. The floor goes on below it, as published.
Geometry standing_block(const std::array<glm::vec2, 4>& plan, float height) {
    const auto corner = [&](size_t i, float y) { return glm::vec3(plan[i % 4].x, y, plan[i % 4].y); };
    Geometry result = face(corner(0, height), corner(1, height), corner(2, height), corner(3, height));
    for (size_t i = 0; i < 4; ++i) {
        append(result, face(corner(i, 0), corner(i + 1, 0), corner(i + 1, height), corner(i, height)));
    }
    return result;
}

}  // namespace

Scene make_cornell() {
    Scene scene;
    const Finish white_paint{add_diffuse_material(scene, "white", white)};
    const Finish red_paint{add_diffuse_material(scene, "red", red)};
    const Finish green_paint{add_diffuse_material(scene, "green", green)};
    const Finish lamp{add_diffuse_material(scene, "lamp", glm::vec3(0.78f))};
    scene.materials[lamp.material].emission = lamp_radiance;

    const std::array<glm::vec3, 4> lamp_corners{glm::vec3(343, 548.8f, 227), glm::vec3(343, 548.8f, 332),
                                                glm::vec3(213, 548.8f, 332), glm::vec3(213, 548.8f, 227)};
    Model room;
    append(room[white_paint], face({552.8f, 0, 0}, {0, 0, 0}, {0, 0, 559.2f}, {549.6f, 0, 559.2f}));
    append(room[white_paint], ceiling_around(lamp_corners));
    append(room[white_paint],
           face({549.6f, 0, 559.2f}, {0, 0, 559.2f}, {0, 548.8f, 559.2f}, {556, 548.8f, 559.2f}));
    append(room[green_paint], face({0, 0, 559.2f}, {0, 0, 0}, {0, 548.8f, 0}, {0, 548.8f, 559.2f}));
    append(room[red_paint],
           face({552.8f, 0, 0}, {549.6f, 0, 559.2f}, {556, 548.8f, 559.2f}, {556, 548.8f, 0}));
    append(room[lamp], face(lamp_corners[0], lamp_corners[1], lamp_corners[2], lamp_corners[3]));

    Model short_block, tall_block;
    append(short_block[white_paint], standing_block({{{130, 65}, {82, 225}, {240, 272}, {290, 114}}}, 165));
    append(tall_block[white_paint], standing_block({{{423, 247}, {265, 296}, {314, 456}, {472, 406}}}, 330));

    for (uint32_t mesh : {add_mesh(scene, "room", room), add_mesh(scene, "short block", short_block),
                          add_mesh(scene, "tall block", tall_block)}) {
        scene.instances.push_back({.mesh = mesh});
    }
    // Focal length 35 mm behind a film 25 mm high.
    scene.cameras.push_back({.name = "front",
                             .position = scale * glm::vec3(278, 273, -800),
                             .target = scale * glm::vec3(278, 273, 0),
                             .vertical_fov = 2 * std::atan(0.025f / 2 / 0.035f),
                             .far_plane = 100});
    return scene;
}

}  // namespace lumo::scene::builtin
