// Named clouds: unions of ellipsoids laid out from a seed. They are the same on every machine.
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

// Returns the preset. INVALID_ARGUMENT lists the names.
absl::StatusOr<CloudShape> PresetNamed(std::string_view name, std::uint64_t seed);

}  // namespace thunderhead::clouds
