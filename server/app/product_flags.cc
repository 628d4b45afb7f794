#include "app/product_flags.h"

#include <memory>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "base/named_file.h"
#include "base/status.h"
#include "pipeline/sha256.h"
#include "product/logo.h"

namespace thunderhead::app {
namespace {

// A logo has at most 4096 x 4096 pixels of 4 bytes.
constexpr std::size_t kMaxLogo_bytes = 64 << 20;

absl::StatusOr<runs::ProductKind> KindOf(const std::string& flag, const std::string& path) {
  static constexpr std::pair<const char*, runs::ProductKind> kEndings[] = {
      {".png", runs::ProductKind::kPng},     {".jpg", runs::ProductKind::kJpeg},
      {".jpeg", runs::ProductKind::kJpeg},   {".exr", runs::ProductKind::kExr},
      {".tif", runs::ProductKind::kGeoTiff}, {".tiff", runs::ProductKind::kGeoTiff},
      {".nc", runs::ProductKind::kNetcdf}};
  for (const auto& [ending, kind] : kEndings) {
    if (absl::EndsWithIgnoreCase(path, ending)) return kind;
  }
  return absl::InvalidArgumentError(absl::StrCat(
      flag, " is '", path, "'; its name must end in .png, .jpg, .jpeg, .exr, .tif or .nc"));
}

}  // namespace

void AddProductOptions(CLI::App& command, ProductFlags& flags) {
  command.add_flag(
      "--annotate", flags.annotate,
      "Draw the title, run time and valid time into the picture, and the legend of false colours");
  command.add_option("--title", flags.title, "With --annotate: the title; by default the storm's");
  command.add_option(
      "--logo", flags.logo,
      "With --annotate: a PNG file for the upper right corner; it may be transparent");
  command.add_flag("--world-file", flags.world_file,
                   "Write a world file (.pgw, .jgw, .tfw) next to each picture from above, with "
                   "its place in the model's map projection");
}

absl::StatusOr<runs::ProductFormat> ProductFormatOf(const std::string& flag,
                                                    const std::string& path,
                                                    const ProductFlags& flags) {
  runs::ProductFormat format;
  THUNDERHEAD_ASSIGN_OR_RETURN(format.kind, KindOf(flag, path));
  format.annotate = flags.annotate;
  format.title = flags.title;
  format.world_file = flags.world_file;
  if (!flags.annotate && (!flags.title.empty() || !flags.logo.empty())) {
    return absl::InvalidArgumentError(
        "--title and --logo have an effect only with --annotate: add it");
  }
  if (format.Drawn() == v1::IMAGE_FORMAT_EXR && (format.annotate || format.world_file)) {
    return absl::InvalidArgumentError(
        absl::StrCat(flag, " is '", path,
                     "', which contains radiance and no pixels for --annotate or --world-file; "
                     "omit them, or use a .png, .jpg or .tif"));
  }
  std::string png;
  if (!flags.logo.empty()) {
    auto read = base::ReadBoundedFile(flags.logo, kMaxLogo_bytes);
    if (!read.ok()) {
      return absl::InvalidArgumentError(
          absl::StrCat("--logo cannot be read: ", read.status().message()));
    }
    png = *std::move(read);
    THUNDERHEAD_ASSIGN_OR_RETURN(product::Logo logo,
                                 product::Logo::Decode(png, absl::StrCat("--logo ", flags.logo)));
    format.logo = std::make_shared<const product::Logo>(std::move(logo));
  }
  if (format.annotate || format.world_file) {
    format.fingerprint =
        absl::StrCat("annotate ", format.annotate, "\ntitle ", format.title, "\nlogo ",
                     pipeline::Sha256(png), "\nworld file ", format.world_file);
  }
  return format;
}

}  // namespace thunderhead::app
