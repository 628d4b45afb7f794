// Effective radii that a file gives, cell by cell, in place of one radius for a whole field.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "physics/hydrometeors.h"

namespace thunderhead::volume {

// A file's variable from which radii follow.
struct SizeVariable {
  std::string name;       // e.g. "RE_CLOUD" or "QNRAIN"
  bool is_count = false;  // particles per kg of dry air, not radii in m
};

// The radii of one field. Nothing is held where the file has none.
struct ParticleSizes {
  std::string variable;  // empty: none
  // Of each cell: a half float of 1 / R over kInverseRadiusUnit_per_m, 2^-12 off at most.
  std::vector<std::uint16_t> inverse_radius;
  float mean_radius_m = 0.0F;  // effective radius of the whole field

  bool Empty() const { return inverse_radius.empty(); }
};

// Radii from 1e-7 to 0.1 m are normal half floats.
inline constexpr float kInverseRadiusUnit_per_m = 512.0F;

// 1 / R in 1/m; `half` is a normal half float above zero.
inline float InverseRadius_per_m(std::uint16_t half) {
  return kInverseRadiusUnit_per_m *
         std::bit_cast<float>((static_cast<std::uint32_t>(half) << 13U) + 0x38000000U);
}

// Turns what the file says of particles' size in each cell into 1 / R (1/m), in place; cells where
// that makes no sense get the hydrometeor's default radius. `mixing_ratios` are kg per kg of dry
// air.
void ToInverseRadius(physics::Hydrometeor hydrometeor, const SizeVariable& variable,
                     const std::vector<float>& mixing_ratios, std::vector<float>& sizes);

// Sizes of cells with `concentration` (kg/m3) of which `concentration_per_radius` (kg/m4) is left
// after remapping: R is such that extinction, which goes with the latter, is kept.
ParticleSizes SizesOf(const std::string& variable, const std::vector<float>& concentration,
                      const std::vector<float>& concentration_per_radius);

}  // namespace thunderhead::volume
