// Converts a drawn picture to the product file that a command was asked for. Files that the service
// has encoded are used unchanged. Annotations, maps and netCDF are added here, in the same way for
// pictures drawn in this process, by a server, or by a render job.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "product/logo.h"
#include "thunderhead/v1/thunderhead.pb.h"

namespace thunderhead::runs {

enum class ProductKind { kPng, kJpeg, kExr, kGeoTiff, kNetcdf };

struct ProductFormat {
  ProductKind kind = ProductKind::kPng;
  bool annotate = false;
  std::string title;  // if empty, MakeProduct chooses the title
  std::shared_ptr<const product::Logo> logo;
  bool world_file = false;
  // A hash of all settings except the scene that affect the file; empty if there are none.
  std::string fingerprint;

  // Returns the image format to request from the service.
  v1::ImageFormat Drawn() const;
  // Returns true if movies can be made from the files.
  bool IsPicture() const { return kind == ProductKind::kPng || kind == ProductKind::kJpeg; }
  bool IsMap() const {
    return world_file || kind == ProductKind::kGeoTiff || kind == ProductKind::kNetcdf;
  }
};

// Returns INVALID_ARGUMENT if the scene cannot be saved in this format. For example, a map needs a
// top-down camera.
absl::Status CheckScene(const ProductFormat& format, const v1::Scene& scene);

// Returns the path of a picture's world file. By the convention of GIS programs, it ends in .pgw,
// .jgw or .tfw.
std::string WorldFilePath(const std::string& path);

struct ProductFile {
  std::string bytes;
  std::optional<std::string> world_file;  // the text of the world file
};

// Makes the file from a picture that was requested as `format.Drawn()`. The title of an annotation
// is `format.title`. If that is empty, it is `storm`, or else the title in the picture. Returns
// INVALID_ARGUMENT for a map that is not seen from above, and for a GeoTIFF of a storm whose map
// projection is unknown.
absl::StatusOr<ProductFile> MakeProduct(const ProductFormat& format, const std::string& storm,
                                        v1::RenderImageResponse picture);

}  // namespace thunderhead::runs
