// The parts of the atrium: a court of 9 by 5 bays with arcades on two floors. Parts that belong to a side of
// the court are modelled in that side's frame: x along it, y up from the court's floor, z toward the court,
// the origin on the columns' axis (of a bay, or of the whole side, as said).
#pragma once

#include <array>
#include <glm/glm.hpp>

#include "scene/builtin/geometry.hpp"
#include "scene/scene.hpp"

namespace lumo::scene::builtin::atrium {

// Metres. Heights are above the court's floor.
constexpr float bay_width = 2.8f;
constexpr int long_bays = 9, short_bays = 5;
constexpr glm::vec2 half_axes =
    0.5f * bay_width * glm::vec2(long_bays, short_bays);  ///< court to columns' axes
constexpr float wall_half = 0.25f;                        ///< half of the arcade walls' thickness
constexpr float gallery_depth = 3.4f;                     ///< from the columns' axis to the back wall's face
constexpr float back_wall = 0.5f;                         ///< thickness
constexpr float ground_floor = 0.30f, ground_spring = 3.75f;
constexpr float upper_floor = 5.70f, upper_spring = 8.95f, ceiling = 10.75f, wall_top = 11.20f;
constexpr float pedestal = 1.0f;      ///< height of the upper columns' pedestals and of the balustrade
constexpr float arch_radius = 1.12f;  ///< of the opening
constexpr float arch_ring = 0.26f;    ///< radial width of the archivolt
constexpr float step_edge = 1.05f;    ///< from the columns' axis to the lowest step's riser
constexpr float paving_edge = 1.40f;  ///< from the columns' axis to the court's inlaid paving

struct Palette {
    Finish limestone, ashlar, rosso, plaster, rose_plaster, marble, inlay, brick, clay, wood, glaze, bronze,
        water, leaf, fruit, soil;
    std::array<Finish, 5> cloth;  ///< red, green, blue, ochre, linen
};
Palette add_palette(Scene& scene);

/// One of the court's four sides; the long ones are 0 (at -Z) and 2.
struct Side {
    float length;  ///< between the corner axes
    int bays;
    glm::mat4 placement;  ///< world from the side's frame, its origin in the middle of the side
};
Side side(int index);

// Arcades: of a bay, or of the axis between two.
Model ground_column(const Palette& palette);  ///< stands on ground_floor
Model upper_column(const Palette& palette);   ///< with its pedestal, on upper_floor
Model corner_pier(const Palette& palette);    ///< both floors
Model ground_arch(const Palette& palette);
Model upper_arch(const Palette& palette);
Model balustrade(const Palette& palette);
Model roundel(const Palette& palette);  ///< on the wall over a column

// Galleries.
Model vault(const Palette& palette, float half_width);  ///< groin vault of a bay
Model vault_rib(const Palette& palette);                ///< with its pilaster at the back wall
Model door(const Palette& palette);                     ///< on the ground floor's back wall
Model window(const Palette& palette);                   ///< on the upper floor's back wall
Model beams(const Palette& palette);                    ///< of a bay's ceiling

// What runs along a whole side: cornices, steps, walls, floors, ceilings, roof.
Model side_work(const Palette& palette, int index);

// The court.
Model court_floor(const Palette& palette);
Model fountain(const Palette& palette);
Model lemon_tree(const Palette& palette);  ///< in its pot

// Cloth; all double-sided sheets.
Model drawn_curtain(const Finish& cloth, const Palette& palette);  ///< closed, in a ground arch
Model tied_curtain(const Finish& cloth, const Palette& palette);   ///< two halves held back at the columns
Model banner(const Finish& cloth, const Finish& trim);             ///< over the balustrade of a bay

}  // namespace lumo::scene::builtin::atrium
