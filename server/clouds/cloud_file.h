// A generated cloud as a storm file that says how it was made.
#pragma once

#include <cstdint>
#include <stop_token>
#include <string>

#include "absl/status/status.h"
#include "clouds/cloud_shape.h"
#include "clouds/generator.h"

namespace thunderhead::clouds {

// What a shape began as.
struct CloudOrigin {
  std::string preset;
  std::uint64_t seed = 1;
};

// Generates the cloud and writes it to `path`, a CF netCDF file. Nothing is left behind if it fails
// or is stopped. Errors are those of Generate and of the file.
absl::Status WriteGenerated(const CloudShape& shape, const CloudOrigin& origin,
                            const std::string& path, const GenerateObserver& observer,
                            const std::stop_token& stop);

// Whether a file says that WriteGenerated wrote it.
bool IsGenerated(const std::string& path);

}  // namespace thunderhead::clouds
