// The effective radius of the particles in each cell. It comes from a storm file or from the
// microphysics scheme of its model, and replaces one constant radius for the whole field.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "physics/hydrometeors.h"
#include "physics/size_distributions.h"

namespace thunderhead::volume {

// A file's variable from which radii are computed.
struct SizeVariable {
  std::string name;       // e.g. "RE_CLOUD" or "QNRAIN"
  bool is_count = false;  // true if values are numbers of particles per kg of dry air, false if
                          // radii in m
};

// Sources of a model's particle sizes, best first. The first available source is used.
enum class SizeOrigin { kEffectiveRadius, kNumber, kScheme, kObserved };
inline constexpr SizeOrigin kLastSizeOrigin = SizeOrigin::kObserved;

// The radii of one field. The array is empty if all cells have the constant radius that is typical
// of observations.
struct ParticleSizes {
  SizeOrigin origin = SizeOrigin::kObserved;
  std::string name;  // name of the file's variable or of the scheme
  // For each cell from the first to the last with particles, the half float of 1 / R in units of
  // kInverseRadiusUnit_per_m, where R is the effective radius. The relative error is at most 2^-12.
  std::vector<std::uint16_t> inverse_radius;
  std::size_t first_cell = 0;
  float mean_radius_m = 0.0F;  // effective radius of the whole field

  bool Empty() const { return inverse_radius.empty(); }
  std::size_t EndCell() const { return first_cell + inverse_radius.size(); }
};

// With this unit, radii from 1e-7 to 0.1 m are normal half floats.
inline constexpr float kInverseRadiusUnit_per_m = 512.0F;

// Returns 1 / R in 1/m for a value of ParticleSizes::inverse_radius, which must be a normal half
// float above zero.
inline float InverseRadius_per_m(std::uint16_t half) {
  return kInverseRadiusUnit_per_m *
         std::bit_cast<float>((static_cast<std::uint32_t>(half) << 13U) + 0x38000000U);
}

// Returns 1 / R in 1/m for `cell`, which must have particles.
inline float InverseRadius_per_m(const ParticleSizes& sizes, std::size_t cell) {
  return InverseRadius_per_m(sizes.inverse_radius[cell - sizes.first_cell]);
}

// Converts each cell's size variable (a radius or a number of particles) into a radius (m), in
// place. Impossible values become NaN. `mixing_ratios` are kg per kg of dry air.
void ToRadius(physics::Hydrometeor hydrometeor, const SizeVariable& variable,
              const std::vector<float>& mixing_ratios, std::vector<float>& sizes);

// Converts each cell's radius into concentration over radius (kg/m4), in place. A cell whose radius
// is NaN gets the radius from the scheme's size distribution. If the scheme has none for this
// hydrometeor, the cell gets the observed constant. `temperature_K` may be empty if the scheme does
// not need it.
void ToConcentrationPerRadius(physics::Hydrometeor hydrometeor, physics::Microphysics microphysics,
                              const std::vector<float>& concentration_kg_per_m3,
                              const std::vector<float>& temperature_K, std::vector<float>& radii);

// Returns the sizes of cells from `concentration` (kg/m3) and `concentration_per_radius` (kg/m4)
// after remapping. The radius R of a cell is `concentration` divided by `concentration_per_radius`.
// Remapping conserves concentration over radius, so it also conserves extinction, which is
// proportional to it. `origin` provides the origin and its name.
ParticleSizes SizesOf(const ParticleSizes& origin, const std::vector<float>& concentration,
                      const std::vector<float>& concentration_per_radius);

}  // namespace thunderhead::volume
