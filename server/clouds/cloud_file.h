// Writes a generated cloud as a storm file, which contains the cloud's parameters as an attribute.
#pragma once

#include <cstdint>
#include <stop_token>
#include <string>

#include "absl/status/status.h"
#include "clouds/cloud_shape.h"
#include "clouds/generator.h"

namespace thunderhead::clouds {

// The preset and seed from which a shape was made.
struct CloudOrigin {
  std::string preset;
  std::uint64_t seed = 1;
};

// Generates the cloud and writes it to `path`, a CF netCDF file. If the function fails or is
// stopped, it leaves no file. Errors are those of Generate and of writing the file.
absl::Status WriteGenerated(const CloudShape& shape, const CloudOrigin& origin,
                            const std::string& path, const GenerateObserver& observer,
                            const std::stop_token& stop);

// Returns whether the file at `path` was written by WriteGenerated, according to its `source`
// attribute.
bool IsGenerated(const std::string& path);

}  // namespace thunderhead::clouds
