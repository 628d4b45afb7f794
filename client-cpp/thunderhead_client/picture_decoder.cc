#include "thunderhead_client/picture_decoder.h"

#include <avif/avif.h>
#include <libyuv.h>
#include <turbojpeg.h>
#include <vpx/vp8dx.h>
#include <vpx/vpx_decoder.h>

#include <algorithm>
#include <array>
#include <string>

#include "absl/strings/str_cat.h"

namespace thunderhead::client {
namespace {

constexpr int kChannels = 4;
constexpr int kMaxSide_px = 16384;

absl::Status Resize(int width_px, int height_px, Pixels& pixels) {
  if (width_px < 1 || height_px < 1 || width_px > kMaxSide_px || height_px > kMaxSide_px) {
    return absl::InvalidArgumentError(
        absl::StrCat("a picture of ", width_px, " x ", height_px, " pixels cannot be shown"));
  }
  pixels.width_px = width_px;
  pixels.height_px = height_px;
  pixels.rgbx.resize(static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px) *
                     kChannels);
  return absl::OkStatus();
}

absl::Status AvifError(avifResult result) {
  return absl::InvalidArgumentError(
      absl::StrCat("the AVIF frame cannot be decoded: ", avifResultToString(result)));
}

// Rounds 10 bits to 8 with ordered dithering, because a clear sky would otherwise show bands.
void DitherTo8Bits(const std::vector<std::uint16_t>& deep, Pixels& pixels) {
  constexpr int kSide = 4;
  constexpr std::array<std::uint16_t, 16> kBayer{0, 8,  2, 10, 12, 4, 14, 6,
                                                 3, 11, 1, 9,  15, 7, 13, 5};
  std::size_t at = 0;
  for (int y = 0; y < pixels.height_px; ++y) {
    for (int x = 0; x < pixels.width_px; ++x) {
      const auto noise = static_cast<unsigned>(kBayer.at((y % kSide) * kSide + x % kSide)) / 4U;
      for (int channel = 0; channel < kChannels; ++channel, ++at) {
        pixels.rgbx[at] = static_cast<std::uint8_t>(std::min(255U, (deep[at] + noise) / 4U));
      }
    }
  }
}

}  // namespace

struct PictureDecoder::State {
  tjhandle jpeg = tjInitDecompress();
  vpx_codec_ctx_t video{};
  bool video_open = false;
  bool has_key_frame = false;
  std::vector<std::uint16_t> deep;  // decoded AVIF pixels with 10 bits a channel

  State() = default;
  ~State() {
    if (jpeg != nullptr) tjDestroy(jpeg);
    CloseVideo();
  }
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  void CloseVideo() {
    if (video_open) vpx_codec_destroy(&video);
    video_open = has_key_frame = false;
  }
};

PictureDecoder::PictureDecoder() : state_(std::make_unique<State>()) {}

PictureDecoder::~PictureDecoder() = default;

void PictureDecoder::Restart() { state_->CloseVideo(); }

absl::Status PictureDecoder::Decode(const v1::Frame& frame, bool wanted, Pixels& pixels) {
  if (!frame.vp9().empty()) return DecodeVp9(frame, wanted, pixels);
  if (!frame.avif().empty()) return DecodeAvif(frame.avif(), pixels);
  return DecodeJpeg(frame.jpeg(), pixels);
}

absl::Status PictureDecoder::DecodeJpeg(const std::string& bytes, Pixels& pixels) {
  if (state_->jpeg == nullptr) return absl::InternalError("cannot start the JPEG decoder");
  const auto* const data = reinterpret_cast<const unsigned char*>(bytes.data());
  int width_px = 0;
  int height_px = 0;
  int subsampling = 0;
  int colorspace = 0;
  if (tjDecompressHeader3(state_->jpeg, data, bytes.size(), &width_px, &height_px, &subsampling,
                          &colorspace) != 0) {
    return absl::InvalidArgumentError(
        absl::StrCat("the JPEG cannot be decoded: ", tjGetErrorStr2(state_->jpeg)));
  }
  if (absl::Status status = Resize(width_px, height_px, pixels); !status.ok()) return status;
  if (tjDecompress2(state_->jpeg, data, bytes.size(), pixels.rgbx.data(), width_px, 0, height_px,
                    TJPF_RGBX, TJFLAG_FASTDCT) != 0 &&
      tjGetErrorCode(state_->jpeg) == TJERR_FATAL) {
    return absl::InvalidArgumentError(
        absl::StrCat("the JPEG cannot be decoded: ", tjGetErrorStr2(state_->jpeg)));
  }
  return absl::OkStatus();
}

// Decodes VP9 with the colours of JPEG: full-range BT.601 4:2:0.
absl::Status PictureDecoder::DecodeVp9(const v1::Frame& frame, bool wanted, Pixels& pixels) {
  if (!state_->video_open) {
    if (vpx_codec_dec_init(&state_->video, vpx_codec_vp9_dx(), nullptr, 0) != VPX_CODEC_OK) {
      return absl::InternalError("cannot start the VP9 decoder");
    }
    state_->video_open = true;
  }
  state_->has_key_frame = state_->has_key_frame || frame.key_frame();
  if (!state_->has_key_frame) return absl::DataLossError("video without a key frame before it");
  vpx_codec_ctx_t* const codec = &state_->video;
  if (vpx_codec_decode(codec, reinterpret_cast<const std::uint8_t*>(frame.vp9().data()),
                       static_cast<unsigned>(frame.vp9().size()), nullptr, 0) != VPX_CODEC_OK) {
    state_->CloseVideo();
    return absl::DataLossError("a frame of video cannot be decoded");
  }
  vpx_codec_iter_t next = nullptr;
  const vpx_image_t* const image = vpx_codec_get_frame(codec, &next);
  if (image == nullptr) return absl::DataLossError("a video frame contains no picture");
  if (!wanted) return absl::OkStatus();
  const auto width_px = static_cast<int>(image->d_w);
  const auto height_px = static_cast<int>(image->d_h);
  if (absl::Status status = Resize(width_px, height_px, pixels); !status.ok()) return status;
  libyuv::J420ToABGR(image->planes[VPX_PLANE_Y], image->stride[VPX_PLANE_Y],
                     image->planes[VPX_PLANE_U], image->stride[VPX_PLANE_U],
                     image->planes[VPX_PLANE_V], image->stride[VPX_PLANE_V], pixels.rgbx.data(),
                     width_px * kChannels, width_px, height_px);
  return absl::OkStatus();
}

absl::Status PictureDecoder::DecodeAvif(const std::string& bytes, Pixels& pixels) {
  const std::unique_ptr<avifDecoder, decltype(&avifDecoderDestroy)> decoder(avifDecoderCreate(),
                                                                            &avifDecoderDestroy);
  const std::unique_ptr<avifImage, decltype(&avifImageDestroy)> image(avifImageCreateEmpty(),
                                                                      &avifImageDestroy);
  decoder->maxThreads = 1;
  avifResult result =
      avifDecoderReadMemory(decoder.get(), image.get(),
                            reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
  if (result != AVIF_RESULT_OK) return AvifError(result);
  absl::Status status =
      Resize(static_cast<int>(image->width), static_cast<int>(image->height), pixels);
  if (!status.ok()) return status;
  constexpr int kBits = 10;
  state_->deep.resize(pixels.rgbx.size());
  avifRGBImage rgb{};
  avifRGBImageSetDefaults(&rgb, image.get());
  rgb.depth = kBits;
  rgb.format = AVIF_RGB_FORMAT_RGBA;
  rgb.pixels = reinterpret_cast<std::uint8_t*>(state_->deep.data());
  rgb.rowBytes = image->width * kChannels * sizeof(std::uint16_t);
  result = avifImageYUVToRGB(image.get(), &rgb);
  if (result != AVIF_RESULT_OK) return AvifError(result);
  DitherTo8Bits(state_->deep, pixels);
  return absl::OkStatus();
}

}  // namespace thunderhead::client
