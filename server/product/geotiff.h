// A top-down picture as a GeoTIFF by GDAL, in the model's own map projection.
#pragma once

#include <map>
#include <string>

#include "absl/status/statusor.h"
#include "frame/image_codec.h"
#include "product/map_place.h"

namespace thunderhead::product {

// The file's bytes: red, green and blue of 8 bits, losslessly compressed. `texts` go into its
// metadata by their names. `place` has a projection. FAILED_PRECONDITION where there is no GDAL.
// Safe from any thread.
absl::StatusOr<std::string> EncodeGeoTiff(const frame::RgbImage& image, const MapPlace& place,
                                          const std::map<std::string, std::string>& texts);

}  // namespace thunderhead::product
