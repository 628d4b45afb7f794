// Effective radii from a file, cell by cell, instead of one radius for a whole field.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "physics/hydrometeors.h"

namespace thunderhead::volume {

// A file's variable from which radii are computed.
struct SizeVariable {
  std::string name;       // e.g. "RE_CLOUD" or "QNRAIN"
  bool is_count = false;  // particles per kg of dry air, not radii in m
};

// The radii of one field; empty if the file has none.
struct ParticleSizes {
  std::string variable;  // empty: none
  // For each cell the half float of 1 / R over kInverseRadiusUnit_per_m; relative error at most
  // 2^-12.
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

// Converts each cell's size variable (a radius or a number of particles) into 1 / R (1/m), in
// place; cells with an impossible value get the hydrometeor's default radius. `mixing_ratios` are
// kg per kg of dry air.
void ToInverseRadius(physics::Hydrometeor hydrometeor, const SizeVariable& variable,
                     const std::vector<float>& mixing_ratios, std::vector<float>& sizes);

// Sizes of cells from `concentration` (kg/m3) and `concentration_per_radius` (kg/m4) after
// remapping: R is their ratio, so that extinction, proportional to the latter, is kept.
ParticleSizes SizesOf(const std::string& variable, const std::vector<float>& concentration,
                      const std::vector<float>& concentration_per_radius);

}  // namespace thunderhead::volume
