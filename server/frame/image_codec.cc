#include "frame/image_codec.h"

#include <png.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <turbojpeg.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/status.h"
#include "frame/jpeg_strips.h"

namespace thunderhead::frame {
namespace {

constexpr int kRgbChannels = 3;
// The largest width or height that JPEG allows.
constexpr int kMaxSide_px = 65535;
// Side of a minimum coded unit of JPEG with 4:2:0 chroma.
constexpr int kUnitSide_px = 16;
constexpr int kMaxRestartInterval = 65535;
// Minimum number of pixels in a strip. Encoding fewer pixels takes less than about half a
// millisecond, for which a thread is not worthwhile.
constexpr double kMinStripPixels = 3e5;

struct TurboDeleter {
  void operator()(void* handle) const { tjDestroy(handle); }
};
using TurboHandle = std::unique_ptr<void, TurboDeleter>;

struct TurboBufferDeleter {
  void operator()(unsigned char* buffer) const { tjFree(buffer); }
};

// Frees libpng's memory of an image at the end of a function.
struct PngImage {
  png_image image{};
  PngImage() { image.version = PNG_IMAGE_VERSION; }
  ~PngImage() { png_image_free(&image); }
  PngImage(const PngImage&) = delete;
  PngImage& operator=(const PngImage&) = delete;
};

std::size_t ByteCount(int width_px, int height_px) {
  return static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px) * kRgbChannels;
}

absl::Status CheckPixels(int width_px, int height_px, std::size_t bytes) {
  if (width_px < 1 || height_px < 1 || width_px > kMaxSide_px || height_px > kMaxSide_px) {
    return absl::InvalidArgumentError(absl::StrCat("a picture of ", width_px, " x ", height_px,
                                                   " pixels cannot be encoded; each side must be "
                                                   "between 1 and ",
                                                   kMaxSide_px));
  }
  if (bytes != ByteCount(width_px, height_px)) {
    return absl::InvalidArgumentError(absl::StrCat("a picture of ", width_px, " x ", height_px,
                                                   " pixels needs ", ByteCount(width_px, height_px),
                                                   " bytes, but ", bytes, " were given"));
  }
  return absl::OkStatus();
}

absl::Status TurboError(const char* action, void* handle) {
  return absl::InternalError(absl::StrCat(action, ": ", tjGetErrorStr2(handle)));
}

int UnitsInRow(int width_px) { return (width_px + kUnitSide_px - 1) / kUnitSide_px; }

// Returns the first row of each strip in which a picture is encoded, followed by the picture's
// height. All strips except the last have the same height. The number of coded units in a strip is
// at most the maximum restart interval.
std::vector<int> StripRows(int width_px, int height_px) {
  const int unit_rows = (height_px + kUnitSide_px - 1) / kUnitSide_px;
  const double pixels = static_cast<double>(width_px) * height_px;
  const int strips = std::clamp(static_cast<int>(pixels / kMinStripPixels), 1,
                                std::min(tbb::info::default_concurrency(), unit_rows));
  const int rows = (unit_rows + strips - 1) / strips;
  if (strips == 1 || rows * UnitsInRow(width_px) > kMaxRestartInterval) return {0, height_px};
  std::vector<int> first;
  for (int row = 0; row < unit_rows; row += rows) first.push_back(row * kUnitSide_px);
  first.push_back(height_px);
  return first;
}

absl::StatusOr<std::string> EncodeStrip(int width_px, int height_px,
                                        absl::Span<const std::uint8_t> rgb, int quality) {
  const TurboHandle handle(tjInitCompress());
  if (handle == nullptr) return TurboError("cannot start the JPEG encoder", nullptr);
  unsigned char* buffer = nullptr;
  unsigned long size = 0;
  const int result = tjCompress2(handle.get(), rgb.data(), width_px, width_px * kRgbChannels,
                                 height_px, TJPF_RGB, &buffer, &size, TJSAMP_420, quality, 0);
  const std::unique_ptr<unsigned char, TurboBufferDeleter> owned(buffer);
  if (result != 0) return TurboError("cannot encode the picture as JPEG", handle.get());
  return std::string(reinterpret_cast<const char*>(buffer), size);
}

}  // namespace

absl::StatusOr<std::string> EncodeJpeg(int width_px, int height_px,
                                       absl::Span<const std::uint8_t> rgb, int quality) {
  THUNDERHEAD_RETURN_IF_ERROR(CheckPixels(width_px, height_px, rgb.size()));
  if (quality < 1 || quality > 100) {
    return absl::InvalidArgumentError(
        absl::StrCat("JPEG quality is ", quality, "; it must be between 1 and 100"));
  }
  const std::vector<int> rows = StripRows(width_px, height_px);
  if (rows.size() == 2) return EncodeStrip(width_px, height_px, rgb, quality);
  std::vector<absl::StatusOr<std::string>> encoded(rows.size() - 1);
  tbb::parallel_for(std::size_t{0}, encoded.size(), [&](std::size_t i) {
    const int height = rows[i + 1] - rows[i];
    encoded[i] = EncodeStrip(width_px, height,
                             rgb.subspan(ByteCount(width_px, rows[i]), ByteCount(width_px, height)),
                             quality);
  });
  std::vector<std::string> strips;
  strips.reserve(encoded.size());
  for (absl::StatusOr<std::string>& strip : encoded) {
    THUNDERHEAD_ASSIGN_OR_RETURN(strips.emplace_back(), std::move(strip));
  }
  return JoinJpegStrips(strips, UnitsInRow(width_px) * (rows[1] / kUnitSide_px), height_px);
}

absl::StatusOr<RgbImage> DecodeJpeg(const std::string& jpeg) {
  const TurboHandle handle(tjInitDecompress());
  if (handle == nullptr) return TurboError("cannot start the JPEG decoder", nullptr);
  const auto* data = reinterpret_cast<const unsigned char*>(jpeg.data());
  RgbImage image;
  int subsampling = 0;
  int colorspace = 0;
  if (tjDecompressHeader3(handle.get(), data, jpeg.size(), &image.width_px, &image.height_px,
                          &subsampling, &colorspace) != 0) {
    return absl::InvalidArgumentError(absl::StrCat("not a JPEG: ", tjGetErrorStr2(handle.get())));
  }
  image.rgb.resize(ByteCount(image.width_px, image.height_px));
  if (tjDecompress2(handle.get(), data, jpeg.size(), image.rgb.data(), image.width_px,
                    image.width_px * kRgbChannels, image.height_px, TJPF_RGB, 0) != 0) {
    return absl::InvalidArgumentError(absl::StrCat("broken JPEG: ", tjGetErrorStr2(handle.get())));
  }
  return image;
}

absl::StatusOr<std::string> EncodePng(int width_px, int height_px,
                                      absl::Span<const std::uint8_t> rgb) {
  THUNDERHEAD_RETURN_IF_ERROR(CheckPixels(width_px, height_px, rgb.size()));
  PngImage png;
  png.image.width = static_cast<png_uint_32>(width_px);
  png.image.height = static_cast<png_uint_32>(height_px);
  png.image.format = PNG_FORMAT_RGB;
  // libpng can compute the exact size only by compressing the picture, so the upper bound is
  // reserved.
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png.image);
  std::string file(size, '\0');
  if (png_image_write_to_memory(&png.image, file.data(), &size, 0, rgb.data(), 0, nullptr) == 0) {
    return absl::InternalError(
        absl::StrCat("cannot encode the picture as PNG: ", png.image.message));
  }
  file.resize(size);
  file.shrink_to_fit();
  return file;
}

absl::StatusOr<RgbImage> DecodePng(const std::string& png_file) {
  PngImage png;
  if (png_image_begin_read_from_memory(&png.image, png_file.data(), png_file.size()) == 0) {
    return absl::InvalidArgumentError(absl::StrCat("not a PNG: ", png.image.message));
  }
  png.image.format = PNG_FORMAT_RGB;
  RgbImage image;
  image.width_px = static_cast<int>(png.image.width);
  image.height_px = static_cast<int>(png.image.height);
  image.rgb.resize(ByteCount(image.width_px, image.height_px));
  if (png_image_finish_read(&png.image, nullptr, image.rgb.data(), 0, nullptr) == 0) {
    return absl::InvalidArgumentError(absl::StrCat("broken PNG: ", png.image.message));
  }
  return image;
}

}  // namespace thunderhead::frame
