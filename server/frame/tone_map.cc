#include "frame/tone_map.h"

#include <algorithm>
#include <cmath>

#include "base/status.h"
#include "base/stopwatch.h"
#include "shaders/bindings.h"
#include "shaders/uniforms.h"

namespace thunderhead::frame {
namespace {

// Limits of the automatic exposure, as factors of the exposure at 0 EV. With the upper limit,
// nights stay dark.
constexpr float kMinFactor = 1.0F / 16.0F;
constexpr float kMaxFactor = 64.0F;
// Upper limit of the automatic exposure, as a factor of the exposure of a white card in the sun.
// With this limit, a storm in shadow stays dark.
constexpr float kMaxAboveCard = 2.0F;

constexpr gl::PieceCost kPixel{"tone map", 50.0};
// Guessed cost of reading back a pixel with more than one byte a channel.
constexpr double kFinePixel_ns = 4.0;

struct ToneMapVariant {
  gl::DefineValue filmic;
  gl::DefineValue noise;

  gl::Defines Defines() const { return {{"FILMIC", filmic}, {"NOISE", noise}}; }
};

std::size_t PixelCount(const glm::ivec2& size_px) {
  return static_cast<std::size_t>(size_px.x) * static_cast<std::size_t>(size_px.y);
}

// Allocates the values. For a large size, allocation takes longer than a piece, so it runs without
// the device turn and other contexts can draw.
template <typename Value>
absl::Status Allocate(std::size_t count, gl::Pieces& pieces, std::vector<Value>* values) {
  constexpr std::size_t kLarge_bytes = std::size_t{32} << 20;
  if (count * sizeof(Value) >= kLarge_bytes) return pieces.OffTurn([&] { values->resize(count); });
  values->resize(count);
  return absl::OkStatus();
}

struct PixelFormat {
  GLenum channels;
  GLenum type;
  std::size_t count;  // number of channels
};

// Reads the lower left part of the texture, of the size `size`, into `values`. It reads some rows
// in each piece.
template <typename Value>
absl::Status ReadRows(const gl::Texture2D& texture, const glm::ivec2& size,
                      const PixelFormat& format, gl::Pieces& pieces, Value* values) {
  const std::size_t row = format.count * static_cast<std::size_t>(size.x);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  return pieces.Steps(
      {"read back finely", kFinePixel_ns * size.x}, size.y, [&](int begin, int end) {
        const std::size_t count = row * static_cast<std::size_t>(end - begin);
        glGetTextureSubImage(texture.Get(), 0, 0, begin, 0, size.x, end - begin, 1, format.channels,
                             format.type, static_cast<GLsizei>(count * sizeof(Value)),
                             values + row * static_cast<std::size_t>(begin));
      });
}

// Converts texels to a picture. `values` has four floats a pixel and its rows are from bottom to
// top.
picture::LinearPicture PictureOfTexels(const std::vector<float>& values, const glm::ivec2& size) {
  picture::LinearPicture picture;
  picture.size_px = size;
  picture.radiance.reserve(values.size() / 4);
  picture.opacity.reserve(values.size() / 4);
  const auto width = static_cast<std::size_t>(size.x);
  for (auto y = static_cast<std::size_t>(size.y); y-- > 0;) {
    for (std::size_t x = 0; x < width; ++x) {
      const float* pixel = &values[4 * (y * width + x)];
      picture.radiance.emplace_back(pixel[0], pixel[1], pixel[2]);
      picture.opacity.push_back(pixel[3]);
    }
  }
  return picture;
}

}  // namespace

absl::StatusOr<float> ToneMapper::ExposureOf(const gl::Texture2D& linear,
                                             const scene::Display& display,
                                             const glm::vec3& balance, const WhiteCard& card) {
  if (display.exposure_ev.has_value()) {
    return kExposureAtZeroEv * static_cast<float>(std::exp2(*display.exposure_ev));
  }
  if (brightest_.Get() == 0) brightest_ = gl::Texture2D(GL_R32F, glm::ivec2(1));
  THUNDERHEAD_ASSIGN_OR_RETURN(const gl::Program* program,
                               programs_->Get(gl::ProgramSource::Compute("post/meter.comp")));
  program->Set(uniform::luminance_weights, kLuminance * balance);
  linear.Bind(shaders::kLinearFrameUnit);
  brightest_.BindImage(shaders::kMeterImage, GL_WRITE_ONLY);
  program->Use();
  glDispatchCompute(1, 1, 1);
  glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
  float brightest = 0.0F;
  glGetTextureImage(brightest_.Get(), 0, GL_RED, GL_FLOAT, sizeof(brightest), &brightest);
  const float of_card = std::max(LuminanceOf(card.radiance), 1e-12F);
  brightest = std::max(brightest, of_card / kMaxAboveCard);
  return std::clamp(kJustBelowWhite / brightest, kExposureAtZeroEv * kMinFactor,
                    kExposureAtZeroEv * kMaxFactor);
}

absl::StatusOr<double> ToneMapper::SetTone(const gl::Texture2D& linear, const scene::Scene& scene) {
  const scene::Display& display = scene.display;
  const WhiteCard& card = white_cards_.Of(scene);
  const glm::vec3 balance = display.white_balance ? card.balance : glm::vec3(1.0F);
  THUNDERHEAD_ASSIGN_OR_RETURN(const float exposure, ExposureOf(linear, display, balance, card));
  tone_ = {exposure * balance, display.tone_map == scene::ToneMap::kFilmic};
  return std::log2(exposure / kExposureAtZeroEv);
}

absl::StatusOr<ToneMapped> ToneMapper::Map(const gl::Texture2D& linear, const scene::Scene& scene) {
  base::Stopwatch stopwatch;
  ToneMapped mapped;
  THUNDERHEAD_ASSIGN_OR_RETURN(mapped.exposure_ev, SetTone(linear, scene));
  gl::Pieces& pieces = programs_->Pieces();
  double waited_ms = pieces.WaitedMs();
  display_.Resize(GL_RGBA8, linear.Size());
  THUNDERHEAD_RETURN_IF_ERROR(Draw(linear, linear.Size(), /*noise=*/true, display_));
  glFinish();
  mapped.tone_ms = stopwatch.Restart() - (pieces.WaitedMs() - waited_ms);
  waited_ms = pieces.WaitedMs();
  THUNDERHEAD_ASSIGN_OR_RETURN(mapped.rgb, pixels_.Rgb(display_.texture, pieces));
  mapped.read_back_ms = stopwatch.ElapsedMs() - (pieces.WaitedMs() - waited_ms);
  return mapped;
}

absl::StatusOr<FineImage> ToneMapper::MapFine(const gl::Texture2D& linear) {
  fine_display_.Resize(GL_RGBA16, linear.Size());
  return MapFineTo(fine_display_, linear, linear.Size());
}

absl::StatusOr<FineImage> ToneMapper::MapFine(const gl::Texture2D& linear,
                                              const glm::ivec2& part_px) {
  part_display_.Resize(GL_RGBA16, glm::max(part_display_.texture.Size(), part_px));
  return MapFineTo(part_display_, linear, part_px);
}

absl::StatusOr<FineImage> ToneMapper::MapFineTo(const Display& display, const gl::Texture2D& linear,
                                                const glm::ivec2& part_px) {
  THUNDERHEAD_RETURN_IF_ERROR(Draw(linear, part_px, /*noise=*/false, display));
  FineImage image{part_px.x, part_px.y, {}};
  THUNDERHEAD_RETURN_IF_ERROR(Allocate(PixelCount(part_px) * 3, programs_->Pieces(), &image.rgb));
  THUNDERHEAD_RETURN_IF_ERROR(ReadRows(display.texture, part_px, {GL_RGB, GL_UNSIGNED_SHORT, 3},
                                       programs_->Pieces(), image.rgb.data()));
  return image;
}

void ToneMapper::Display::Resize(GLenum format, const glm::ivec2& size_px) {
  if (texture.Size() == size_px) return;
  texture = gl::Texture2D(format, size_px);
  target = gl::Framebuffer(texture);
}

absl::Status ToneMapper::Draw(const gl::Texture2D& linear, const glm::ivec2& part_px, bool noise,
                              const Display& display) {
  const ToneMapVariant variant{.filmic = tone_.filmic, .noise = noise};
  THUNDERHEAD_ASSIGN_OR_RETURN(
      const gl::Program* program,
      programs_->Get(gl::ProgramSource::WholeTarget("post/tone_map.frag", variant.Defines())));
  program->Set(uniform::gain, tone_.gain);
  program->Set(uniform::just_below_white, kJustBelowWhite);
  linear.Bind(shaders::kLinearFrameUnit);
  program->Set(uniform::mapped_rows, part_px.y);
  return whole_target_.Draw(programs_->Pieces(), kPixel, *program, display.target,
                            {glm::ivec2(0), part_px});
}

absl::StatusOr<std::vector<float>> ReadLinear(const gl::Texture2D& linear, gl::Pieces& pieces) {
  std::vector<float> values;
  THUNDERHEAD_RETURN_IF_ERROR(Allocate(PixelCount(linear.Size()) * 4, pieces, &values));
  THUNDERHEAD_RETURN_IF_ERROR(
      ReadRows(linear, linear.Size(), {GL_RGBA, GL_FLOAT, 4}, pieces, values.data()));
  return values;
}

std::vector<float> ReadLinear(const gl::Texture2D& linear) {
  gl::Pieces whole;
  return *ReadLinear(linear, whole);
}

gl::Texture2D TextureOf(const picture::LinearPicture& picture) {
  const auto width = static_cast<std::size_t>(picture.size_px.x);
  std::vector<float> texels;
  texels.reserve(4 * picture.radiance.size());
  for (auto y = static_cast<std::size_t>(picture.size_px.y); y-- > 0;) {
    for (std::size_t x = 0; x < width; ++x) {
      const glm::vec3& pixel = picture.radiance[y * width + x];
      const float opacity = picture.opacity.empty() ? 1.0F : picture.opacity[y * width + x];
      texels.insert(texels.end(), {pixel.x, pixel.y, pixel.z, opacity});
    }
  }
  gl::Texture2D texture(GL_RGBA32F, picture.size_px);
  texture.Upload(GL_RGBA, GL_FLOAT, texels.data());
  return texture;
}

absl::StatusOr<picture::LinearPicture> PictureOf(const gl::Texture2D& linear, gl::Pieces& pieces) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<float> values, ReadLinear(linear, pieces));
  picture::LinearPicture picture;
  THUNDERHEAD_RETURN_IF_ERROR(
      pieces.OffTurn([&] { picture = PictureOfTexels(values, linear.Size()); }));
  return picture;
}

picture::LinearPicture PictureOf(const gl::Texture2D& linear) {
  gl::Pieces whole;
  return *PictureOf(linear, whole);
}

}  // namespace thunderhead::frame
