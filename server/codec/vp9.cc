#include "codec/vp9.h"

#include <libyuv.h>
#include <vpx/vp8cx.h>
#include <vpx/vp8dx.h>
#include <vpx/vpx_decoder.h>
#include <vpx/vpx_encoder.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/status.h"

namespace thunderhead::codec {
namespace {

constexpr int kMaxVp9Side_px = 16384;
constexpr int kVp9Channels = 3;
constexpr double kPicturesPerSecond = 30.0;
// The range of quantizers. Measurements (decision 28) show that a finer quantizer costs bytes
// without a visible gain in moving pictures.
constexpr unsigned kFinestQuantizer = 24;
constexpr unsigned kCoarsestQuantizer = 56;
// The fastest speed of libvpx.
constexpr int kSpeed = 9;

absl::Status VpxError(const char* action, vpx_codec_ctx_t* codec) {
  const char* const detail = vpx_codec_error_detail(codec);
  return absl::InternalError(absl::StrCat(action, ": ", vpx_codec_error(codec),
                                          detail == nullptr ? "" : ", ",
                                          detail == nullptr ? "" : detail));
}

// Returns the encoder's configuration. It uses one thread, because each encoder thread serves many
// streams.
vpx_codec_enc_cfg_t ConfigFor(int width_px, int height_px) {
  vpx_codec_enc_cfg_t config{};
  vpx_codec_enc_config_default(vpx_codec_vp9_cx(), &config, 0);
  config.g_w = static_cast<unsigned>(width_px);
  config.g_h = static_cast<unsigned>(height_px);
  config.g_threads = 1;
  config.g_timebase = {1, static_cast<int>(kPicturesPerSecond)};
  config.g_lag_in_frames = 0;
  config.g_pass = VPX_RC_ONE_PASS;
  // Droppable pictures may never reach the decoder. Without this option, a picture could be decoded
  // only after every picture before it, even those that it does not refer to. The option costs 2 %
  // of the bytes.
  config.g_error_resilient = VPX_ERROR_RESILIENT_DEFAULT;
  config.kf_mode = VPX_KF_DISABLED;  // key pictures only when they are requested
  config.rc_end_usage = VPX_CBR;
  config.rc_target_bitrate = static_cast<unsigned>(
      std::ceil(Vp9Encoder::BitsPerPicture(width_px, height_px) * kPicturesPerSecond / 1000.0));
  config.rc_min_quantizer = kFinestQuantizer;
  config.rc_max_quantizer = kCoarsestQuantizer;
  config.rc_undershoot_pct = 50;
  config.rc_overshoot_pct = 50;
  config.rc_buf_sz = 1000;  // the three sizes of the buffer are in milliseconds
  config.rc_buf_initial_sz = 500;
  config.rc_buf_optimal_sz = 600;
  config.rc_dropframe_thresh = 0;
  return config;
}

// Returns the flags that say which buffers a picture uses and updates. Only the buffer LAST is
// used.
vpx_enc_frame_flags_t FlagsOf(Vp9Kind kind) {
  if (kind == Vp9Kind::kKey) return VPX_EFLAG_FORCE_KF;
  constexpr vpx_enc_frame_flags_t kOnlyLast =
      VP8_EFLAG_NO_REF_GF | VP8_EFLAG_NO_REF_ARF | VP8_EFLAG_NO_UPD_GF | VP8_EFLAG_NO_UPD_ARF;
  if (kind == Vp9Kind::kBase) return kOnlyLast;
  return kOnlyLast | VP8_EFLAG_NO_UPD_LAST | VP8_EFLAG_NO_UPD_ENTROPY;
}

}  // namespace

struct Vp9Encoder::State {
  vpx_codec_ctx_t codec{};
  bool open = false;
  std::unique_ptr<vpx_image_t, decltype(&vpx_img_free)> image{nullptr, &vpx_img_free};

  State() = default;
  ~State() {
    if (open) vpx_codec_destroy(&codec);
  }
  State(const State&) = delete;
  State& operator=(const State&) = delete;
};

std::size_t Vp9Encoder::BytesFor(int width_px, int height_px) {
  constexpr std::size_t kFixed = std::size_t{10} << 20;
  constexpr std::size_t kPerPixel = 78;
  return kFixed +
         kPerPixel * static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px);
}

double Vp9Encoder::BitsPerPicture(int width_px, int height_px) {
  constexpr double kBits = 1.9e6 / kPicturesPerSecond;
  constexpr double kPixels = 1280.0 * 720.0;
  // Larger pictures have smoother details, so the bits grow more slowly than the pixels.
  return kBits * std::pow(static_cast<double>(width_px) * height_px / kPixels, 0.75);
}

Vp9Encoder::Vp9Encoder(std::unique_ptr<State> state, int width_px, int height_px)
    : state_(std::move(state)), width_px_(width_px), height_px_(height_px) {}

Vp9Encoder::~Vp9Encoder() = default;

absl::StatusOr<std::unique_ptr<Vp9Encoder>> Vp9Encoder::Create(int width_px, int height_px) {
  if (width_px < 1 || height_px < 1 || width_px > kMaxVp9Side_px || height_px > kMaxVp9Side_px) {
    return absl::InvalidArgumentError(absl::StrCat(
        "video of ", width_px, " x ", height_px,
        " pixels cannot be encoded; each side must be between 1 and ", kMaxVp9Side_px));
  }
  auto state = std::make_unique<State>();
  const vpx_codec_enc_cfg_t config = ConfigFor(width_px, height_px);
  if (vpx_codec_enc_init(&state->codec, vpx_codec_vp9_cx(), &config, 0) != VPX_CODEC_OK) {
    return VpxError("cannot start the VP9 encoder", &state->codec);
  }
  state->open = true;
  vpx_codec_ctx_t* const codec = &state->codec;
  // Each control has its own argument type, so the calls cannot be a loop.
  if (vpx_codec_control(codec, VP8E_SET_CPUUSED, kSpeed) != VPX_CODEC_OK ||
      vpx_codec_control(codec, VP9E_SET_AQ_MODE, 3U) != VPX_CODEC_OK ||
      vpx_codec_control(codec, VP9E_SET_COLOR_SPACE, VPX_CS_BT_601) != VPX_CODEC_OK ||
      vpx_codec_control(codec, VP9E_SET_COLOR_RANGE, VPX_CR_FULL_RANGE) != VPX_CODEC_OK) {
    return VpxError("cannot set up the VP9 encoder", codec);
  }
  constexpr unsigned kAlignment_bytes = 32;
  state->image.reset(
      vpx_img_alloc(nullptr, VPX_IMG_FMT_I420, config.g_w, config.g_h, kAlignment_bytes));
  if (state->image == nullptr) {
    return absl::ResourceExhaustedError(
        absl::StrCat("there is not enough memory to encode video of ", width_px, " x ", height_px,
                     " pixels; choose a smaller picture"));
  }
  return std::unique_ptr<Vp9Encoder>(new Vp9Encoder(std::move(state), width_px, height_px));
}

absl::StatusOr<Vp9Picture> Vp9Encoder::Encode(const frame::RgbImage& picture, Vp9Kind kind) {
  if (picture.width_px != width_px_ || picture.height_px != height_px_) {
    return absl::InvalidArgumentError(
        absl::StrCat("a picture of ", picture.width_px, " x ", picture.height_px,
                     " pixels does not belong to video of ", width_px_, " x ", height_px_));
  }
  vpx_image_t& image = *state_->image;
  libyuv::RAWToJ420(picture.rgb.data(), width_px_ * kVp9Channels, image.planes[VPX_PLANE_Y],
                    image.stride[VPX_PLANE_Y], image.planes[VPX_PLANE_U], image.stride[VPX_PLANE_U],
                    image.planes[VPX_PLANE_V], image.stride[VPX_PLANE_V], width_px_, height_px_);
  vpx_codec_ctx_t* const codec = &state_->codec;
  const vpx_enc_frame_flags_t flags = FlagsOf(count_ == 0 ? Vp9Kind::kKey : kind);
  // The timestamps pretend a regular rate. Otherwise the size of a picture would depend on the
  // actual rate.
  if (vpx_codec_encode(codec, &image, count_++, 1, flags, VPX_DL_REALTIME) != VPX_CODEC_OK) {
    return VpxError("cannot encode the picture as VP9", codec);
  }
  Vp9Picture encoded;
  vpx_codec_iter_t next = nullptr;
  while (const vpx_codec_cx_pkt_t* const packet = vpx_codec_get_cx_data(codec, &next)) {
    if (packet->kind != VPX_CODEC_CX_FRAME_PKT) continue;
    encoded.bytes.append(static_cast<const char*>(packet->data.frame.buf), packet->data.frame.sz);
    encoded.key = (packet->data.frame.flags & VPX_FRAME_IS_KEY) != 0;
  }
  if (encoded.bytes.empty()) return absl::InternalError("the VP9 encoder gave no picture");
  return encoded;
}

struct Vp9Decoder::State {
  vpx_codec_ctx_t codec{};
  bool open = false;

  State() = default;
  ~State() {
    if (open) vpx_codec_destroy(&codec);
  }
  State(const State&) = delete;
  State& operator=(const State&) = delete;
};

Vp9Decoder::Vp9Decoder(std::unique_ptr<State> state) : state_(std::move(state)) {}

Vp9Decoder::~Vp9Decoder() = default;

absl::StatusOr<std::unique_ptr<Vp9Decoder>> Vp9Decoder::Create() {
  auto state = std::make_unique<State>();
  if (vpx_codec_dec_init(&state->codec, vpx_codec_vp9_dx(), nullptr, 0) != VPX_CODEC_OK) {
    return VpxError("cannot start the VP9 decoder", &state->codec);
  }
  state->open = true;
  return std::unique_ptr<Vp9Decoder>(new Vp9Decoder(std::move(state)));
}

absl::StatusOr<frame::RgbImage> Vp9Decoder::Decode(const std::string& bytes) {
  vpx_codec_ctx_t* const codec = &state_->codec;
  if (vpx_codec_decode(codec, reinterpret_cast<const std::uint8_t*>(bytes.data()),
                       static_cast<unsigned>(bytes.size()), nullptr, 0) != VPX_CODEC_OK) {
    return VpxError("cannot decode the picture", codec);
  }
  vpx_codec_iter_t next = nullptr;
  const vpx_image_t* const decoded = vpx_codec_get_frame(codec, &next);
  if (decoded == nullptr) return absl::InternalError("the VP9 decoder gave no picture");
  const auto width = static_cast<int>(decoded->d_w);
  const auto height = static_cast<int>(decoded->d_h);
  const auto pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  constexpr int kWithAlpha = 4;
  std::vector<std::uint8_t> argb(pixels * kWithAlpha);
  libyuv::J420ToARGB(decoded->planes[VPX_PLANE_Y], decoded->stride[VPX_PLANE_Y],
                     decoded->planes[VPX_PLANE_U], decoded->stride[VPX_PLANE_U],
                     decoded->planes[VPX_PLANE_V], decoded->stride[VPX_PLANE_V], argb.data(),
                     width * kWithAlpha, width, height);
  frame::RgbImage picture{width, height, std::vector<std::uint8_t>(pixels * kVp9Channels)};
  libyuv::ARGBToRAW(argb.data(), width * kWithAlpha, picture.rgb.data(), width * kVp9Channels,
                    width, height);
  return picture;
}

}  // namespace thunderhead::codec
