// Encodes a top-down picture as radiance in a CF netCDF file, for programs that compute with maps.
// The file has the radiance and its standard error, and the storm's opacity and optical depth. It
// also has the height at which the optical depth reaches 1, and its distance from the eye.
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
  // Altitude of the eye, from which the picture's distances are measured.
  double eye_altitude_m = 0.0;
  absl::Time valid;
  std::optional<absl::Time> run;             // start of the run
  std::optional<double> estimated_error;     // relative RMSE of the radiance
  std::map<std::string, std::string> texts;  // global attributes; "Software" becomes `source`
};

// Returns the file's bytes; `what` names the file in errors. The file follows CF-1.8, with one grid
// cell per pixel. If the place has a projection, the file has `grid_mapping` and the latitude and
// longitude of each pixel. Otherwise the coordinates are metres from the middle of the domain.
// Returns INVALID_ARGUMENT if the conventions have no name for the projection. The function holds
// the lock of netCDF-C while it works, and is safe to call from any thread.
absl::StatusOr<std::string> EncodeLightNetcdf(const LightMap& map, const std::string& what);

}  // namespace thunderhead::product
