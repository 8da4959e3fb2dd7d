// The makers of the built-in scenes; builtin.hpp says what each scene is. make_builtin sets Scene::name.
#pragma once

#include "scene/scene.hpp"

namespace lumo::scene::builtin {

Scene make_atrium();
Scene make_cornell();
Scene make_area_light();
Scene make_area_light_pure();
Scene make_furnace();
Scene make_sky();

}  // namespace lumo::scene::builtin
