// Named cloud shapes (presets): unions of ellipsoids whose positions follow from a seed. The result
// is the same on every machine.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "clouds/cloud_shape.h"

namespace thunderhead::clouds {

// Returns "congestus", "cumulus-field" and "fair-weather-cumulus".
std::vector<std::string> PresetNames();

// Returns the preset with that name. For an unknown name, returns INVALID_ARGUMENT with a list of
// the names.
absl::StatusOr<CloudShape> PresetNamed(std::string_view name, std::uint64_t seed);

}  // namespace thunderhead::clouds
