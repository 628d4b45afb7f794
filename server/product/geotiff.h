// Encodes a top-down picture as a GeoTIFF with GDAL, in the model's own map projection.
#pragma once

#include <map>
#include <string>

#include "absl/status/statusor.h"
#include "frame/image_codec.h"
#include "product/map_place.h"

namespace thunderhead::product {

// Returns the file's bytes: red, green and blue with 8 bits each, with lossless compression.
// `texts` become metadata, with their keys as names. The texts "Software" and "Title" become TIFF's
// own tags. `place` must have a projection. Returns FAILED_PRECONDITION if GDAL is not installed,
// and INVALID_ARGUMENT for a grid with a rotated pole, which GeoTIFF cannot express. The function
// is safe to call from any thread.
absl::StatusOr<std::string> EncodeGeoTiff(const frame::RgbImage& image, const MapPlace& place,
                                          const std::map<std::string, std::string>& texts);

}  // namespace thunderhead::product
