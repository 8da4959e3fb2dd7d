// Columns of air from a table, for integrands that ask for very many.
#pragma once

#include <vector>

#include "reference/atmosphere_optics.hpp"

namespace lumo::reference {

/// Bilinear in a grid of columns that AtmosphereOptics integrated: on Earth transmittance errs by less than 1e-4 of
/// itself. Stored is a column over density · scale height · 2 / (mu + sqrt(mu² + 8 scale height / (pi r))), which is
/// nearly constant; of ozone the column itself.
class ColumnTable {
  public:
    /// Keeps a reference to `optics`.
    explicit ColumnTable(const AtmosphereOptics& optics);

    /// From a point of the air to space along a ray that does not fall; `densities` are those of the point.
    Densities rising(RayPoint from, const Densities& densities) const;
    /// Of all of the line that touches the sphere at an altitude, one way: from there to space.
    Densities level(double h) const;
    /// AtmosphereOptics::sun_column.
    Densities to_sun(double h, double mu_sun, const Densities& densities) const;

  private:
    static constexpr size_t altitudes = 512, cosines = 256;

    /// What the columns of species with these scale heights are divided by, without the density.
    Densities slant(double h, double mu) const;

    const AtmosphereOptics& optics_;
    double rayleigh_scale_ = 1, mie_scale_ = 1;
    std::vector<Densities> grid_;
};

}  // namespace lumo::reference
