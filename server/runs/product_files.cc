#include "runs/product_files.h"

#include <cmath>
#include <filesystem>
#include <map>
#include <utility>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_split.h"
#include "absl/time/time.h"
#include "base/status.h"
#include "base/utc_time.h"
#include "frame/image_codec.h"
#include "frame/png_text.h"
#include "picture/exr_file.h"
#include "product/annotation.h"
#include "product/geotiff.h"
#include "product/light_netcdf.h"
#include "product/map_place.h"
#include "runs/legend.h"
#include "service/messages/picture_texts.h"
#include "volume/map_projection.h"

namespace thunderhead::runs {
namespace {

using Texts = std::map<std::string, std::string>;

std::string TextOr(const Texts& texts, const char* name, const std::string& otherwise) {
  const auto found = texts.find(name);
  return found == texts.end() || found->second.empty() ? otherwise : found->second;
}

std::optional<absl::Time> TimeIn(const Texts& texts, const char* name) {
  return base::ParseUtcTime(TextOr(texts, name, ""));
}

std::string MinuteOf(absl::Time time) {
  return absl::FormatTime("%E4Y-%m-%d %H:%MZ", time, absl::UTCTimeZone());
}

std::string RunText(const Texts& texts, absl::Time valid) {
  const std::optional<absl::Time> run = TimeIn(texts, service::kRunText);
  if (!run.has_value()) return "";
  const std::int64_t minutes = absl::ToInt64Minutes(valid - *run);
  return absl::StrFormat("run %s, %+d h %02d min", MinuteOf(*run), minutes / 60,
                         std::abs(minutes % 60));
}

absl::Status Annotate(const ProductFormat& format, const std::string& storm,
                      const v1::RenderImageResponse& picture, const Texts& texts,
                      frame::RgbImage& image) {
  product::Annotation annotation;
  annotation.title =
      !format.title.empty() ? format.title : (storm.empty() ? TextOr(texts, "Title", "") : storm);
  if (const auto valid = TimeIn(texts, service::kValidText); valid.has_value()) {
    annotation.valid_time = MinuteOf(*valid);
    annotation.run = RunText(texts, *valid);
  }
  annotation.legend = LegendOf(picture);
  annotation.logo = format.logo.get();
  return product::Annotate(annotation, image);
}

// Returns the map's position. Its projection is empty if that of the storm is unknown. Returns
// INVALID_ARGUMENT if the picture is not seen from above.
absl::StatusOr<product::MapPlace> PlaceOf(const v1::RenderImageResponse& picture,
                                          const Texts& texts) {
  const v1::View& view = picture.view();
  if (!view.parallel()) {
    return absl::InvalidArgumentError("the picture is not seen from above; use a top-down camera");
  }
  product::MapPlace place;
  place.projection = TextOr(texts, service::kProjectionText, "");
  place.upper_left_m = {view.eye().x_m() - view.right().x(), view.eye().y_m() + view.up().y()};
  place.pixel_m = {2.0 * view.right().x() / picture.width_px(),
                   2.0 * view.up().y() / picture.height_px()};
  if (place.projection.empty()) return place;
  const std::pair<std::string, std::string> middle =
      absl::StrSplit(TextOr(texts, service::kMiddleText, ""), ' ');
  volume::EarthPlace degrees;
  if (!absl::SimpleAtod(middle.first, &degrees.latitude_deg) ||
      !absl::SimpleAtod(middle.second, &degrees.longitude_deg)) {
    return absl::InternalError("the picture has a map projection, but no place on it");
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(const volume::MapProjection projection,
                               volume::MapProjection::Of(place.projection, degrees));
  place.upper_left_m += projection.Origin_m();
  return place;
}

absl::StatusOr<ProductFile> MakeNetcdf(const v1::RenderImageResponse& picture) {
  THUNDERHEAD_ASSIGN_OR_RETURN(picture::ExrPicture light,
                               picture::DecodeExr(picture.image(), "the server's picture"));
  product::LightMap map;
  map.texts = std::move(light.attributes.texts);
  THUNDERHEAD_ASSIGN_OR_RETURN(map.place, PlaceOf(picture, map.texts));
  map.picture = std::move(light.picture);
  map.eye_altitude_m = picture.view().eye().z_m();
  map.valid = TimeIn(map.texts, service::kValidText).value_or(absl::UnixEpoch());
  map.run = TimeIn(map.texts, service::kRunText);
  if (picture.has_accuracy()) map.estimated_error = picture.accuracy().estimated_error();
  ProductFile file;
  THUNDERHEAD_ASSIGN_OR_RETURN(file.bytes, product::EncodeLightNetcdf(map, "a picture as light"));
  return file;
}

absl::StatusOr<ProductFile> MakeFromPixels(const ProductFormat& format, const std::string& storm,
                                           v1::RenderImageResponse picture) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const Texts texts, frame::TextsOf(picture.image()));
  ProductFile file;
  product::MapPlace place;
  if (format.IsMap()) {
    THUNDERHEAD_ASSIGN_OR_RETURN(place, PlaceOf(picture, texts));
    if (format.world_file) file.world_file = product::WorldFile(place);
  }
  if (format.kind == ProductKind::kGeoTiff && place.projection.empty()) {
    return absl::InvalidArgumentError(
        "a GeoTIFF needs the storm's place on Earth, but the run is idealised or its map "
        "projection is unknown; use a .png, with --world-file for metres from the middle of the "
        "domain");
  }
  if (!format.annotate && format.kind == ProductKind::kPng) {
    file.bytes = std::move(*picture.mutable_image());
    return file;
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(frame::RgbImage image, frame::DecodePng(picture.image()));
  if (format.annotate) {
    THUNDERHEAD_RETURN_IF_ERROR(Annotate(format, storm, picture, texts, image));
  }
  if (format.kind == ProductKind::kGeoTiff) {
    THUNDERHEAD_ASSIGN_OR_RETURN(file.bytes, product::EncodeGeoTiff(image, place, texts));
  } else if (format.kind == ProductKind::kJpeg) {
    const int quality = static_cast<int>(picture.scene().output().jpeg_quality());
    THUNDERHEAD_ASSIGN_OR_RETURN(
        file.bytes, frame::EncodeJpeg(image.width_px, image.height_px, image.rgb, quality));
  } else {
    THUNDERHEAD_ASSIGN_OR_RETURN(const std::string png,
                                 frame::EncodePng(image.width_px, image.height_px, image.rgb));
    file.bytes = frame::WithTexts(png, texts);
  }
  return file;
}

}  // namespace

v1::ImageFormat ProductFormat::Drawn() const {
  if (kind == ProductKind::kExr || kind == ProductKind::kNetcdf) return v1::IMAGE_FORMAT_EXR;
  // If the product is made from the picture here, PNG is requested, because it is lossless.
  return kind == ProductKind::kJpeg && !annotate && !world_file ? v1::IMAGE_FORMAT_JPEG
                                                                : v1::IMAGE_FORMAT_PNG;
}

absl::Status CheckScene(const ProductFormat& format, const v1::Scene& scene) {
  if (!format.IsMap() || scene.camera().has_top_down()) return absl::OkStatus();
  return absl::InvalidArgumentError(
      "a map (.tif, .nc or --world-file) must be seen from above, but the scene's camera is not: "
      "use --camera top-down or a scene with camera.topDown; for another view write a .png or "
      ".exr, which contains the camera's position");
}

std::string WorldFilePath(const std::string& path) {
  // The extension of a world file is the first and the last letter of the picture's extension, and
  // a w.
  const std::filesystem::path picture(path);
  const std::string ending = picture.extension().string();
  return std::filesystem::path(picture)
      .replace_extension(
          absl::StrCat(".", ending.substr(1, 1), ending.substr(ending.size() - 1), "w"))
      .string();
}

absl::StatusOr<ProductFile> MakeProduct(const ProductFormat& format, const std::string& storm,
                                        v1::RenderImageResponse picture) {
  if (format.kind == ProductKind::kNetcdf) return MakeNetcdf(picture);
  if (format.Drawn() == v1::IMAGE_FORMAT_PNG) {
    return MakeFromPixels(format, storm, std::move(picture));
  }
  return ProductFile{std::move(*picture.mutable_image()), std::nullopt};
}

}  // namespace thunderhead::runs
