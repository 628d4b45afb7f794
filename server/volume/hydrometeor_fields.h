// The fields of one time of a storm: the mass of each hydrometeor in every cell of a regular grid,
// with statistics of the file's values. This code does not depend on a scene's optics or on GL.
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
  float minimum = 0.0F;  // in the quantity's unit; includes negative values, excludes missing
                         // values
  float maximum = 0.0F;
  // Mean over columns of the water path: the integral of rho_air q dz. For a field given as
  // extinction it is the optical depth.
  double mean_water_path_kg_per_m2 = 0.0;
  double maximum_water_path_kg_per_m2 = 0.0;  // the largest water path of a column
  std::int64_t negative_cells = 0;            // number of cells with negative values, which are
                                              // treated as zero
  std::int64_t missing_cells = 0;             // number of cells with a fill value, NaN or infinity,
                                              // which are treated as empty
};

// One hydrometeor on the grid.
struct HydrometeorField {
  physics::Hydrometeor hydrometeor = physics::Hydrometeor::kCloud;
  std::string variable;  // name in the file
  Quantity quantity = Quantity::kMixingRatio;
  std::vector<float> concentration_kg_per_m3;  // grid.CellCount() values, x fastest; empty if all
                                               // are zero. For Quantity::kExtinction: extinction in
                                               // 1/m, as if the mass extinction were 1 m2/kg
  FieldStatistics statistics;
  ParticleSizes sizes;  // the particles' sizes in the model
};

// Extinction (1/m) per concentration (kg/m3) of a field.
struct MassExtinction {
  float m2_per_kg = 0.0F;
  bool by_cell = false;  // if true, `m2_per_kg` is for a radius of 1 m; divide it by each cell's
                         // radius in m
};

// Returns the mass extinction of `field`. `sizes` selects the source of the particles' radii. The
// radius of `optics` is used only with SizeSource::kGiven. For a field that the file gives as
// extinction, the result is always 1 m2/kg.
MassExtinction MassExtinctionOf(const HydrometeorField& field,
                                const physics::ParticleOptics& optics, physics::SizeSource sizes);

// Adds the extinction (1/m) of `count` cells, beginning with cell `offset`, to `sums`. The elements
// of `sums` are `stride` apart.
void AddExtinction(const HydrometeorField& field, const MassExtinction& mass_extinction,
                   std::size_t offset, std::size_t count, float* sums, std::size_t stride = 1);

// Returns concentration over radius (kg/m4) of each cell. Extinction is proportional to it. The
// field must have radii.
std::vector<float> ConcentrationPerRadius(const HydrometeorField& field);

// Returns `optics` with its radius replaced by one effective radius for the whole field. This
// radius selects the phase function.
physics::ParticleOptics WithDrawnRadius(const HydrometeorField& field,
                                        physics::ParticleOptics optics, physics::SizeSource sizes);

// The fields of one time of a storm.
struct HydrometeorFields {
  RegularGrid grid;
  std::vector<HydrometeorField>
      fields;  // every field the file has, in the order of physics::kHydrometeors
  std::vector<float> terrain_height_m;  // nx * ny values above sea level, x fastest
  LandSurface land;                     // empty if the file has no land-use data, or no place on
                                        // Earth
  // Coastlines and borders, the same for all times of a storm. Null if the storm's place on Earth
  // is unknown or the border data are not installed. The storm store sets this pointer.
  std::shared_ptr<const BorderMap> borders;
  // The direction of true north in the middle of the domain, in degrees clockwise from the y axis.
  // The storm store sets it.
  double true_north_deg = 0.0;
  AirMotion motion;    // motion of the air
  AirDensity air;      // density of the air, which converts concentrations back to mixing ratios;
                       // empty if the file has no mixing ratios
  CellBox condensate;  // the smallest box that contains every cell with condensate

  // Returns the size of all arrays in bytes, including arrays that are shared with other times.
  std::size_t Bytes() const;
};

}  // namespace thunderhead::volume
