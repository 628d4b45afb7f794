// The recipe of each table of data/phase: the drops or crystals, the angles and the amount of work.
// Tests run the same recipes with less work.
#pragma once

#include <string>
#include <vector>

#include "physics/chunked_work.h"
#include "physics/droplets.h"
#include "physics/ice_crystals.h"
#include "physics/phase_accumulator.h"
#include "physics/phase_table.h"

namespace thunderhead::physics {

struct DropletRecipe {
  std::string name;
  DropletSizes sizes;
  std::vector<GridSpan> grid;
  int radii;   // number of quadrature points over the sizes
  int points;  // number of quadrature points within each step of the grid
};

struct IceRecipe {
  std::string name;
  IceCrystal crystal;
  std::vector<GridSpan> grid;
  std::int64_t rays;
  int orientations;  // number of orientations for diffraction
  std::uint64_t seed;
};

std::vector<DropletRecipe> DropletRecipes();
std::vector<IceRecipe> IceRecipes();

// A table, and the lines about its origin for the top of its file.
struct BuiltTable {
  PhaseTable table;
  std::string provenance;
};
// Build tables for sunlight. The tables are averaged over the sun's disc. Tables of water are also
// averaged over the band of wavelengths of each colour channel.
BuiltTable Build(const DropletRecipe& recipe, const WorkPlan& plan);
BuiltTable Build(const IceRecipe& recipe, const WorkPlan& plan);

}  // namespace thunderhead::physics
