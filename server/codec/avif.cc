#include "codec/avif.h"

#include <avif/avif.h>

#include <cstddef>
#include <cstdint>
#include <memory>

#include "absl/strings/str_cat.h"

namespace thunderhead::codec {
namespace {

constexpr int kBits = 10;
// Bits per value in libavif's pixels: the smallest layout that holds all bits of a FineImage.
constexpr int kPixelBits = 16;
constexpr int kAvifChannels = 3;
constexpr int kMaxAvifSide_px = 16384;

using Image = std::unique_ptr<avifImage, decltype(&avifImageDestroy)>;

absl::Status AvifError(const char* action, avifResult result) {
  return absl::InternalError(absl::StrCat(action, ": ", avifResultToString(result)));
}

// Returns the view of `pixels` that libavif uses.
avifRGBImage PixelsOf(const avifImage& image, std::uint16_t* pixels) {
  avifRGBImage rgb{};
  avifRGBImageSetDefaults(&rgb, &image);
  rgb.depth = kPixelBits;
  rgb.format = AVIF_RGB_FORMAT_RGB;
  rgb.pixels = reinterpret_cast<std::uint8_t*>(pixels);
  rgb.rowBytes = image.width * kAvifChannels * static_cast<std::uint32_t>(sizeof(std::uint16_t));
  return rgb;
}

}  // namespace

absl::StatusOr<std::string> EncodeAvif(const frame::FineImage& image, const AvifOptions& options) {
  const auto values = static_cast<std::size_t>(image.width_px) *
                      static_cast<std::size_t>(image.height_px) * kAvifChannels;
  if (image.width_px < 1 || image.height_px < 1 || image.width_px > kMaxAvifSide_px ||
      image.height_px > kMaxAvifSide_px || image.rgb.size() != values) {
    return absl::InvalidArgumentError(
        absl::StrCat("a picture of ", image.width_px, " x ", image.height_px, " pixels with ",
                     image.rgb.size(), " values cannot be encoded as AVIF; each side must be 1 to ",
                     kMaxAvifSide_px, " pixels, with three values a pixel"));
  }
  const Image coded(
      avifImageCreate(image.width_px, image.height_px, kBits, AVIF_PIXEL_FORMAT_YUV444),
      &avifImageDestroy);
  coded->colorPrimaries = AVIF_COLOR_PRIMARIES_BT709;
  coded->transferCharacteristics = AVIF_TRANSFER_CHARACTERISTICS_SRGB;
  coded->matrixCoefficients = AVIF_MATRIX_COEFFICIENTS_BT709;
  coded->yuvRange = AVIF_RANGE_FULL;
  // The cast is safe because libavif only reads the pixels.
  const avifRGBImage rgb = PixelsOf(*coded, const_cast<std::uint16_t*>(image.rgb.data()));
  if (const avifResult result = avifImageRGBToYUV(coded.get(), &rgb); result != AVIF_RESULT_OK) {
    return AvifError("cannot convert the picture for AVIF", result);
  }
  const std::unique_ptr<avifEncoder, decltype(&avifEncoderDestroy)> encoder(avifEncoderCreate(),
                                                                            &avifEncoderDestroy);
  encoder->maxThreads = 1;
  encoder->speed = options.speed;
  encoder->minQuantizer = options.quantizer;
  encoder->maxQuantizer = options.quantizer;
  struct Output {
    avifRWData data = AVIF_DATA_EMPTY;
    Output() = default;
    ~Output() { avifRWDataFree(&data); }
    Output(const Output&) = delete;
    Output& operator=(const Output&) = delete;
  } output;
  if (const avifResult result = avifEncoderWrite(encoder.get(), coded.get(), &output.data);
      result != AVIF_RESULT_OK) {
    return AvifError("cannot encode the picture as AVIF", result);
  }
  return std::string(reinterpret_cast<const char*>(output.data.data), output.data.size);
}

absl::StatusOr<frame::FineImage> DecodeAvif(const std::string& avif) {
  const std::unique_ptr<avifDecoder, decltype(&avifDecoderDestroy)> decoder(avifDecoderCreate(),
                                                                            &avifDecoderDestroy);
  const Image coded(avifImageCreateEmpty(), &avifImageDestroy);
  avifResult result = avifDecoderReadMemory(
      decoder.get(), coded.get(), reinterpret_cast<const std::uint8_t*>(avif.data()), avif.size());
  if (result != AVIF_RESULT_OK) {
    return absl::InvalidArgumentError(absl::StrCat("not an AVIF: ", avifResultToString(result)));
  }
  frame::FineImage image{static_cast<int>(coded->width), static_cast<int>(coded->height), {}};
  image.rgb.resize(static_cast<std::size_t>(coded->width) * coded->height * kAvifChannels);
  avifRGBImage rgb = PixelsOf(*coded, image.rgb.data());
  result = avifImageYUVToRGB(coded.get(), &rgb);
  if (result != AVIF_RESULT_OK) return AvifError("cannot convert the picture of the AVIF", result);
  return image;
}

}  // namespace thunderhead::codec
