// Encodes a top-down picture as radiance in a CF netCDF file, for programs that calculate with
// maps. The file has the radiance, the storm's opacity and optical depth, and the height at which
// the optical depth reaches 1.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "picture/linear_picture.h"
#include "product/map_place.h"

namespace thunderhead::product {

struct LightMap {
  picture::LinearPicture picture;  // with north up
  MapPlace place;
  double eye_altitude_m = 0.0;  // altitude from which distances are measured
  absl::Time valid;
  std::optional<absl::Time> run;             // start of the run
  std::optional<double> estimated_error;     // relative RMSE of the radiance
  std::map<std::string, std::string> texts;  // global attributes
};

// Returns the file's bytes; `what` names them in errors. The file follows CF-1.8 on the picture's
// pixels. If the place has a projection, it has `grid_mapping` and each pixel's latitude and
// longitude. Otherwise coordinates are metres from the middle of the domain. Holds the lock of
// netCDF-C. Safe from any thread.
absl::StatusOr<std::string> EncodeLightNetcdf(const LightMap& map, const std::string& what);

}  // namespace thunderhead::product
