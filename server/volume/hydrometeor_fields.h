// One time of a storm: the mass of each hydrometeor in every cell of a regular grid, with what was
// found in the file. Knows nothing of optics' parameters (a scene's) and of GL.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "physics/hydrometeors.h"
#include "volume/grid.h"

namespace thunderhead::volume {

// What was found in the file for one field at one time.
struct FieldStatistics {
  float minimum_kg_per_kg = 0.0F;  // before negatives were clamped; missing cells left out
  float maximum_kg_per_kg = 0.0F;
  double mean_water_path_kg_per_m2 = 0.0;     // mean over columns of the integral of rho_air q dz
  double maximum_water_path_kg_per_m2 = 0.0;  // largest column
  std::int64_t negative_cells = 0;            // below zero, taken as zero
  std::int64_t missing_cells = 0;             // fill value, NaN or infinite, taken as empty
};

// One hydrometeor on the grid.
struct HydrometeorField {
  physics::Hydrometeor hydrometeor = physics::Hydrometeor::kCloud;
  std::string variable;  // name in the file
  std::vector<float>
      concentration_kg_per_m3;  // grid.CellCount() values, x fastest; empty if all are zero
  FieldStatistics statistics;
};

// One time of a storm.
struct HydrometeorFields {
  RegularGrid grid;
  std::vector<HydrometeorField>
      fields;  // every field the file has, in the order of physics::kHydrometeors
  std::vector<float> terrain_height_m;  // nx * ny values above sea level, x fastest
  CellBox condensate;                   // the smallest box that holds every cell with condensate

  // Bytes that the arrays take.
  std::size_t Bytes() const;
};

}  // namespace thunderhead::volume
