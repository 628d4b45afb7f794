// One time of a storm: the mass of each hydrometeor in every cell of a regular grid, with
// statistics of the file's values. Knows neither a scene's optics nor GL.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "physics/hydrometeors.h"
#include "physics/particle_size.h"
#include "volume/air_density.h"
#include "volume/air_motion.h"
#include "volume/border_map.h"
#include "volume/grid.h"
#include "volume/land_surface.h"
#include "volume/particle_sizes.h"

namespace thunderhead::volume {

// The quantity that a file has of a hydrometeor: mass per mass of air (kg/kg), mass per volume of
// air (kg/m3), or the extinction of its particles (1/m).
enum class Quantity { kMixingRatio, kMassConcentration, kExtinction };
inline constexpr Quantity kLastQuantity = Quantity::kExtinction;

// The unit of a quantity: "kg kg-1", "kg m-3" or "m-1".
std::string_view UnitOf(Quantity quantity);

// Statistics of the file's values for one field at one time.
struct FieldStatistics {
  float minimum = 0.0F;  // in the quantity's unit; before negatives were clamped; missing left out
  float maximum = 0.0F;
  // Mean over columns of the integral of rho_air q dz; of extinction it is an optical depth.
  double mean_water_path_kg_per_m2 = 0.0;
  double maximum_water_path_kg_per_m2 = 0.0;  // largest column
  std::int64_t negative_cells = 0;            // below zero, taken as zero
  std::int64_t missing_cells = 0;             // fill value, NaN or infinite, taken as empty
};

// One hydrometeor on the grid.
struct HydrometeorField {
  physics::Hydrometeor hydrometeor = physics::Hydrometeor::kCloud;
  std::string variable;  // name in the file
  Quantity quantity = Quantity::kMixingRatio;
  std::vector<float>
      concentration_kg_per_m3;  // grid.CellCount() values, x fastest; empty if all are zero. Of
                                // Quantity::kExtinction: extinction in 1/m, a mass of 1 m2/kg
  FieldStatistics statistics;
  ParticleSizes sizes;  // as the model has them
};

// Extinction (1/m) per concentration (kg/m3) of a field.
struct MassExtinction {
  float m2_per_kg = 0.0F;
  bool by_cell = false;  // `m2_per_kg` is for a radius of 1 m and is divided by each cell's own
};

// The mass extinction of `field` with `optics` and the radii that `sizes` tells; that of `optics`
// counts if they are given. 1 m2/kg for a field given as extinction, whatever the optics.
MassExtinction MassExtinctionOf(const HydrometeorField& field,
                                const physics::ParticleOptics& optics, physics::SizeSource sizes);

// Adds the extinction (1/m) of `count` cells from `offset` on to `sums`, which lie `stride` apart.
void AddExtinction(const HydrometeorField& field, const MassExtinction& mass_extinction,
                   std::size_t offset, std::size_t count, float* sums, std::size_t stride = 1);

// Concentration over radius (kg/m4) of each cell, to which extinction is proportional. The field
// has radii.
std::vector<float> ConcentrationPerRadius(const HydrometeorField& field);

// `optics` with the effective radius of all the field's particles together, by which their phase
// function is chosen.
physics::ParticleOptics WithDrawnRadius(const HydrometeorField& field,
                                        physics::ParticleOptics optics, physics::SizeSource sizes);

// One time of a storm.
struct HydrometeorFields {
  RegularGrid grid;
  std::vector<HydrometeorField>
      fields;  // every field the file has, in the order of physics::kHydrometeors
  std::vector<float> terrain_height_m;  // nx * ny values above sea level, x fastest
  LandSurface land;                     // empty if the file has no land use of a real place
  // Coasts and borders, the same for all times of a storm; null if its place or their data are not
  // known. By the store.
  std::shared_ptr<const BorderMap> borders;
  AirMotion motion;    // of the air
  AirDensity air;      // that mixing ratios refer to; empty if there are none
  CellBox condensate;  // the smallest box that holds every cell with condensate

  // Memory of the arrays in bytes, those that other times share included.
  std::size_t Bytes() const;
};

}  // namespace thunderhead::volume
