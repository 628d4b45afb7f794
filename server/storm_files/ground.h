// The ground below a storm's layers: which heights it can have, and what it hides.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "absl/status/status.h"

namespace thunderhead::storm_files {

// No ground of the Earth is lower or higher. The limits leave room for the spurious waves in the
// terrain of spectral models.
inline constexpr float kLowestGround_m = -500.0F;
inline constexpr float kHighestGround_m = 9000.0F;

// Checks the heights of the ground, x fastest, in rows of `row` columns. NaN is a missing height.
// Returns INVALID_ARGUMENT, which begins with `where` and names the first wrong column, if a height
// is impossible or all are missing.
absl::Status CheckGround(const std::string& where, const std::vector<float>& ground_m,
                         std::size_t row);

// Checks that each column with an amount in one of its layers has a height of the ground. Columns
// outside the model's domain have neither. `amounts` has `ground_m.size()` values for each layer,
// NaN if missing. Returns INVALID_ARGUMENT, which begins with `where`.
absl::Status CheckGroundBelow(const std::string& where, const std::vector<float>& ground_m,
                              const std::vector<float>& amounts, std::size_t row);

// Moves the interfaces of layers that lie below the ground up to it, but not above the highest
// interface of their column. Layers below the ground then have no thickness, and count as missing.
// Returns whether an interface was moved. Columns without a height are left as they are.
bool RaiseToGround(const std::vector<float>& ground_m, std::vector<float>& interface_height_m);

}  // namespace thunderhead::storm_files
