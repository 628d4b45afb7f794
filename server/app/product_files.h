// Converts a drawn picture to the file that a command was asked for. What the service encodes is
// used unchanged. Annotations, maps and netCDF are added here, in the same way for pictures drawn
// in this process, by a server, or by a job.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "CLI/CLI.hpp"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "product/logo.h"
#include "thunderhead/v1/thunderhead.pb.h"

namespace thunderhead::app {

struct ProductFlags {
  bool annotate = false;
  std::string title;  // if empty, the storm's title
  std::string logo;   // a file; empty for none
  bool world_file = false;
};

void AddProductOptions(CLI::App& command, ProductFlags& flags);

enum class ProductKind { kPng, kJpeg, kExr, kGeoTiff, kNetcdf };

struct ProductFormat {
  ProductKind kind = ProductKind::kPng;
  bool annotate = false;
  std::string title;  // if empty, the storm's title
  std::shared_ptr<const product::Logo> logo;
  bool world_file = false;
  // A hash of everything that changes the file in addition to the scene; empty if there is nothing.
  std::string fingerprint;

  // Returns the image format to request from the service.
  v1::ImageFormat Drawn() const;
  // Returns true for files from which movies can be made.
  bool IsPicture() const { return kind == ProductKind::kPng || kind == ProductKind::kJpeg; }
  bool IsMap() const {
    return world_file || kind == ProductKind::kGeoTiff || kind == ProductKind::kNetcdf;
  }
};

// Returns the format from the ending of a product's name and the flags. INVALID_ARGUMENT names a
// wrong flag, and DATA_LOSS reports a bad logo.
absl::StatusOr<ProductFormat> ProductFormatOf(const std::string& flag, const std::string& path,
                                              const ProductFlags& flags);

// Returns INVALID_ARGUMENT if the scene cannot be such a product, for example because a map needs a
// view from above.
absl::Status CheckScene(const ProductFormat& format, const v1::Scene& scene);

// Returns the path of a picture's world file, by the convention of GIS programs: .pgw, .jgw, .tfw.
std::string WorldFilePath(const std::string& path);

struct ProductFile {
  std::string bytes;
  std::optional<std::string> world_file;  // the text of the world file
};

// Makes the file of a picture that was drawn as `format.Drawn()`. `storm` is the title if neither
// the flags nor the picture have one. Returns INVALID_ARGUMENT for a map of a storm without a place
// on Earth.
absl::StatusOr<ProductFile> MakeProduct(const ProductFormat& format, const std::string& storm,
                                        v1::RenderImageResponse picture);

}  // namespace thunderhead::app
