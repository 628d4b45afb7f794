// Makes clouds with analytically known results, for tests. A slab is a box that touches every face
// of its domain, so that its extinction is the same everywhere inside.
#pragma once

#include <algorithm>
#include <memory>

#include "volume/hydrometeor_fields.h"

namespace thunderhead::support {

// Makes a box that is `width_m` wide and `height_m` high and stands on z = 0. Its cloud water has
// the given extinction with the default radius and density.
inline std::shared_ptr<const volume::HydrometeorFields> MakeSlab(
    double width_m, double height_m, double extinction_per_m,
    const glm::ivec3& cells = glm::ivec3(32, 32, 16)) {
  auto fields = std::make_shared<volume::HydrometeorFields>();
  fields->grid.cells = cells;
  fields->grid.spacing_m = glm::dvec3(width_m, width_m, height_m) / glm::dvec3(cells);
  fields->grid.low_corner_m = {-width_m / 2, -width_m / 2, 0.0};
  fields->condensate = {glm::ivec3(0), cells};
  const physics::ParticleOptics& cloud = physics::DefaultOptics(physics::Hydrometeor::kCloud);
  const float mass_extinction =
      physics::MassExtinction_m2_per_kg(cloud.density_kg_per_m3, cloud.radius_m);
  volume::HydrometeorField field;
  field.hydrometeor = physics::Hydrometeor::kCloud;
  field.concentration_kg_per_m3.assign(fields->grid.CellCount(),
                                       static_cast<float>(extinction_per_m) / mass_extinction);
  fields->fields.push_back(std::move(field));
  return fields;
}

// Makes a horizontal cloud layer in the middle of a domain that is `height_m` high. The layer is
// `cells_thick` cells thick, and there is no cloud above or below it. At its upper and lower edge
// the extinction therefore rises linearly over one cell, as in a storm. `optical_depth` is the
// vertical optical depth of the whole layer.
inline std::shared_ptr<const volume::HydrometeorFields> MakeLayerInAir(double width_m,
                                                                       double height_m,
                                                                       int cells_thick,
                                                                       double optical_depth) {
  const double cell_m = height_m / 16;
  const auto slab = MakeSlab(width_m, height_m, optical_depth / (cells_thick * cell_m));
  auto fields = std::make_shared<volume::HydrometeorFields>(*slab);
  const int low = (16 - cells_thick) / 2;
  const volume::RegularGrid& grid = fields->grid;
  std::vector<float>& concentration = fields->fields[0].concentration_kg_per_m3;
  for (int z = 0; z < grid.cells.z; ++z) {
    if (z >= low && z < low + cells_thick) continue;
    std::fill_n(concentration.begin() + static_cast<std::ptrdiff_t>(grid.Offset(0, 0, z)),
                grid.cells.x * grid.cells.y, 0.0F);
  }
  fields->condensate = {{0, 0, low}, {grid.cells.x, grid.cells.y, low + cells_thick}};
  return fields;
}

}  // namespace thunderhead::support
