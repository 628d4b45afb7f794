#include "product/geotiff.h"

#include <array>
#include <atomic>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/status.h"
#include "product/gdal_library.h"
#include "volume/map_projection.h"

namespace thunderhead::product {
namespace {

// A file in GDAL's memory with its dataset. The destructor removes both.
class TiffInMemory {
 public:
  explicit TiffInMemory(const GdalLibrary& gdal) : gdal_(gdal), name_(FreshName()) {
    gdal_.PushErrorHandler(gdal_.QuietErrorHandler);
  }
  ~TiffInMemory() {
    (void)Close();
    gdal_.Unlink(name_.c_str());
    gdal_.PopErrorHandler();
  }
  TiffInMemory(const TiffInMemory&) = delete;
  TiffInMemory& operator=(const TiffInMemory&) = delete;

  bool Create(int width_px, int height_px) {
    GDALDriverH const driver = gdal_.GetDriverByName("GTiff");
    if (driver == nullptr) return false;
    std::string compress = "COMPRESS=DEFLATE";
    std::string predictor = "PREDICTOR=2";
    std::string photometric = "PHOTOMETRIC=RGB";
    const std::array<char*, 4> options = {compress.data(), predictor.data(), photometric.data(),
                                          nullptr};
    dataset_ = gdal_.Create(driver, name_.c_str(), width_px, height_px, 3, GDT_Byte,
                            const_cast<char**>(options.data()));
    return dataset_ != nullptr;
  }

  bool Place(const MapPlace& place, const std::string& well_known_text) {
    std::array<double, 6> transform = {
        place.upper_left_m.x, place.pixel_m.x, 0.0, place.upper_left_m.y, 0.0, -place.pixel_m.y};
    return gdal_.SetGeoTransform(dataset_, transform.data()) == CE_None &&
           gdal_.SetProjection(dataset_, well_known_text.c_str()) == CE_None;
  }

  bool Describe(const std::map<std::string, std::string>& texts) {
    bool all = true;
    for (const auto& [name, text] : texts) {
      const std::string item = name == "Software" ? "TIFFTAG_SOFTWARE"
                               : name == "Title"  ? "TIFFTAG_DOCUMENTNAME"
                                                  : name;
      all = all && gdal_.SetMetadataItem(dataset_, item.c_str(), text.c_str(), nullptr) == CE_None;
    }
    return all;
  }

  bool Write(const frame::RgbImage& image) {
    // GDAL's parameter is not const, but GDAL only reads the pixels here.
    auto* const pixels = const_cast<std::uint8_t*>(image.rgb.data());
    return gdal_.DatasetRasterIo(dataset_, GF_Write, 0, 0, image.width_px, image.height_px, pixels,
                                 image.width_px, image.height_px, GDT_Byte, 3, nullptr, 3,
                                 3 * image.width_px, 1) == CE_None;
  }

  // Returns the file, which is complete only after closing.
  std::string Take() {
    if (!Close()) return "";
    vsi_l_offset count = 0;
    GByte* const bytes = gdal_.GetMemFileBuffer(name_.c_str(), &count, TRUE);
    if (bytes == nullptr) return "";
    std::string file(reinterpret_cast<const char*>(bytes), count);
    gdal_.Free(bytes);
    return file;
  }

  std::string Reason() const { return gdal_.GetLastErrorMsg(); }

 private:
  static std::string FreshName() {
    static std::atomic<int> next{0};
    return absl::StrCat("/vsimem/thunderhead_", next++, ".tif");
  }

  bool Close() {
    if (dataset_ == nullptr) return false;
    gdal_.Close(std::exchange(dataset_, nullptr));
    return true;
  }

  const GdalLibrary& gdal_;
  const std::string name_;
  GDALDatasetH dataset_ = nullptr;
};

}  // namespace

absl::StatusOr<std::string> EncodeGeoTiff(const frame::RgbImage& image, const MapPlace& place,
                                          const std::map<std::string, std::string>& texts) {
  THUNDERHEAD_CHECK(!place.projection.empty(), "a GeoTIFF without a projection");
  THUNDERHEAD_ASSIGN_OR_RETURN(const GdalLibrary* gdal, GdalLibrary::Get());
  THUNDERHEAD_ASSIGN_OR_RETURN(const volume::MapProjection projection,
                               volume::MapProjection::Open(place.projection));
  if (projection.Text().HasRotatedPole()) {
    return absl::InvalidArgumentError(
        "a GeoTIFF cannot state the place of a grid with a rotated pole; use a .nc, or a .png with "
        "--world-file");
  }
  TiffInMemory tiff(*gdal);
  std::string file;
  if (tiff.Create(image.width_px, image.height_px) &&
      tiff.Place(place, projection.WellKnownText(volume::MapProjection::WellKnown::kGdal)) &&
      tiff.Describe(texts) && tiff.Write(image)) {
    file = tiff.Take();
  }
  if (!file.empty()) return file;
  return absl::InternalError(absl::StrCat("GDAL cannot encode the GeoTIFF: ", tiff.Reason()));
}

}  // namespace thunderhead::product
