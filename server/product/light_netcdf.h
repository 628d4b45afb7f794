// A top-down picture as light in a CF netCDF file, for programs that calculate with maps: radiance,
// the storm's opacity and optical depth, and the height at which that reaches 1.
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
  double eye_altitude_m = 0.0;  // from which distances count
  absl::Time valid;
  std::optional<absl::Time> run;             // when it began
  std::optional<double> estimated_error;     // relative RMSE of the radiance
  std::map<std::string, std::string> texts;  // global attributes
};

// The file's bytes; `what` names them in errors. CF-1.8 on the picture's pixels, with
// `grid_mapping` and each pixel's latitude and longitude where the place has a projection; metres
// from the middle of the domain where it has none. Holds the lock of netCDF-C. Safe from any
// thread.
absl::StatusOr<std::string> EncodeLightNetcdf(const LightMap& map, const std::string& what);

}  // namespace thunderhead::product
