// One time of a storm: the mass of each hydrometeor in every cell of a regular grid, with
// statistics of the file's values. This code does not depend on a scene's optics or on GL.
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

// The quantity in which a file stores a hydrometeor. It is mass per mass of air (kg/kg), mass per
// volume of air (kg/m3), or the extinction of its particles (1/m).
enum class Quantity { kMixingRatio, kMassConcentration, kExtinction };
inline constexpr Quantity kLastQuantity = Quantity::kExtinction;

// Returns the unit of a quantity: "kg kg-1", "kg m-3" or "m-1".
std::string_view UnitOf(Quantity quantity);

// Statistics of the file's values for one field at one time.
struct FieldStatistics {
  float minimum = 0.0F;  // in the quantity's unit; negative values count, missing do not
  float maximum = 0.0F;
  // Mean over columns of the integral of rho_air q dz. For extinction it is an optical depth.
  double mean_water_path_kg_per_m2 = 0.0;
  double maximum_water_path_kg_per_m2 = 0.0;  // largest column
  std::int64_t negative_cells = 0;            // below zero, treated as zero
  std::int64_t missing_cells = 0;             // fill value, NaN or infinite, treated as empty
};

// One hydrometeor on the grid.
struct HydrometeorField {
  physics::Hydrometeor hydrometeor = physics::Hydrometeor::kCloud;
  std::string variable;  // name in the file
  Quantity quantity = Quantity::kMixingRatio;
  std::vector<float> concentration_kg_per_m3;  // grid.CellCount() values, x fastest; empty if all
                                               // are zero. For Quantity::kExtinction: extinction in
                                               // 1/m, i.e. a mass with 1 m2/kg
  FieldStatistics statistics;
  ParticleSizes sizes;  // sizes in the model
};

// Extinction (1/m) per concentration (kg/m3) of a field.
struct MassExtinction {
  float m2_per_kg = 0.0F;
  bool by_cell = false;  // `m2_per_kg` is for a radius of 1 m and is divided by each cell's radius
};

// Returns the mass extinction of `field`. `sizes` selects the source of the particles' radii. The
// radius of `optics` is used only with SizeSource::kGiven. A field given as extinction has 1 m2/kg,
// whatever the optics.
MassExtinction MassExtinctionOf(const HydrometeorField& field,
                                const physics::ParticleOptics& optics, physics::SizeSource sizes);

// Adds the extinction (1/m) of `count` cells from `offset` on to `sums`, whose elements are
// `stride` apart.
void AddExtinction(const HydrometeorField& field, const MassExtinction& mass_extinction,
                   std::size_t offset, std::size_t count, float* sums, std::size_t stride = 1);

// Returns concentration over radius (kg/m4) of each cell. Extinction is proportional to it. The
// field must have radii.
std::vector<float> ConcentrationPerRadius(const HydrometeorField& field);

// Returns `optics` with the effective radius of all the field's particles together, which selects
// their phase function.
physics::ParticleOptics WithDrawnRadius(const HydrometeorField& field,
                                        physics::ParticleOptics optics, physics::SizeSource sizes);

// One time of a storm.
struct HydrometeorFields {
  RegularGrid grid;
  std::vector<HydrometeorField>
      fields;  // every field the file has, in the order of physics::kHydrometeors
  std::vector<float> terrain_height_m;  // nx * ny values above sea level, x fastest
  LandSurface land;                     // empty if the file has no land use of a real place
  // Coasts and borders, the same for all times of a storm. Null if the storm's place or the border
  // data are unknown. The store sets them.
  std::shared_ptr<const BorderMap> borders;
  AirMotion motion;    // motion of the air
  AirDensity air;      // air for mixing ratios; empty if there are none
  CellBox condensate;  // the smallest box that holds every cell with condensate

  // Returns the memory of the arrays in bytes, including arrays that other times share.
  std::size_t Bytes() const;
};

}  // namespace thunderhead::volume
