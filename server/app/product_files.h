// From a drawn picture to the file that a command was asked for: what the service encodes is taken
// as it is; annotations, maps and netCDF are made of it here, alike for pictures that were drawn in
// this process, by a server, and by a job.
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
  std::string title;  // empty: the storm's
  std::string logo;   // a file; empty: none
  bool world_file = false;
};

void AddProductOptions(CLI::App& command, ProductFlags& flags);

enum class ProductKind { kPng, kJpeg, kExr, kGeoTiff, kNetcdf };

struct ProductFormat {
  ProductKind kind = ProductKind::kPng;
  bool annotate = false;
  std::string title;  // empty: the storm's
  std::shared_ptr<const product::Logo> logo;
  bool world_file = false;
  // Of all that changes the file beside the scene; empty if nothing does.
  std::string fingerprint;

  // The requested picture.
  v1::ImageFormat Drawn() const;
  // True for files that movies are made of.
  bool IsPicture() const { return kind == ProductKind::kPng || kind == ProductKind::kJpeg; }
  bool IsMap() const {
    return world_file || kind == ProductKind::kGeoTiff || kind == ProductKind::kNetcdf;
  }
};

// By the ending of a product's name and the flags; INVALID_ARGUMENT names the flag that is wrong,
// DATA_LOSS a logo that is none.
absl::StatusOr<ProductFormat> ProductFormatOf(const std::string& flag, const std::string& path,
                                              const ProductFlags& flags);

// INVALID_ARGUMENT if the scene cannot be such a product, as a map is seen from above.
absl::Status CheckScene(const ProductFormat& format, const v1::Scene& scene);

// Where the world file of a picture goes, by the custom of GIS programs: .pgw, .jgw, .tfw.
std::string WorldFilePath(const std::string& path);

struct ProductFile {
  std::string bytes;
  std::optional<std::string> world_file;  // its text
};

// The file of a picture that was drawn as `format.Drawn()`. `storm` is its title where neither the
// flags nor, if it is empty, the picture has one. INVALID_ARGUMENT for a map of a storm without a
// place on Earth.
absl::StatusOr<ProductFile> MakeProduct(const ProductFormat& format, const std::string& storm,
                                        v1::RenderImageResponse picture);

}  // namespace thunderhead::app
