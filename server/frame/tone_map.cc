#include "frame/tone_map.h"

#include <cmath>

#include "base/status.h"
#include "base/stopwatch.h"
#include "shaders/bindings.h"
#include "shaders/uniforms.h"

namespace thunderhead::frame {
namespace {

struct ToneMapVariant {
  gl::DefineValue filmic;

  gl::Defines Defines() const { return {{"FILMIC", filmic}}; }
};

std::size_t PixelCount(const gl::Texture2D& texture) {
  return static_cast<std::size_t>(texture.Size().x) * static_cast<std::size_t>(texture.Size().y);
}

}  // namespace

absl::StatusOr<ToneMapped> ToneMapper::Map(const gl::Texture2D& linear,
                                           const scene::Display& display) {
  base::Stopwatch stopwatch;
  if (display_.Size() != linear.Size()) {
    display_ = gl::Texture2D(GL_RGBA8, linear.Size());
    target_ = gl::Framebuffer(display_);
  }
  const ToneMapVariant variant{.filmic = display.tone_map == scene::ToneMap::kFilmic};
  THUNDERHEAD_ASSIGN_OR_RETURN(
      const gl::Program* program,
      programs_.Get(gl::ProgramSource::WholeTarget("post/tone_map.frag", variant.Defines())));
  program->Set(uniform::exposure,
               kExposureAtZeroEv * static_cast<float>(std::exp2(display.exposure_ev)));
  linear.Bind(shaders::kLinearFrameUnit);
  whole_target_.Draw(*program, target_);
  glFinish();
  ToneMapped mapped;
  mapped.tone_ms = stopwatch.Restart();
  mapped.rgb.resize(PixelCount(linear) * 3);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glGetTextureImage(display_.Get(), 0, GL_RGB, GL_UNSIGNED_BYTE,
                    static_cast<GLsizei>(mapped.rgb.size()), mapped.rgb.data());
  mapped.read_back_ms = stopwatch.ElapsedMs();
  return mapped;
}

std::vector<float> ReadLinear(const gl::Texture2D& linear) {
  std::vector<float> values(PixelCount(linear) * 4);
  glGetTextureImage(linear.Get(), 0, GL_RGBA, GL_FLOAT,
                    static_cast<GLsizei>(values.size() * sizeof(float)), values.data());
  return values;
}

gl::Texture2D TextureOf(const picture::LinearPicture& picture) {
  const auto width = static_cast<std::size_t>(picture.size_px.x);
  std::vector<float> texels;
  texels.reserve(4 * picture.radiance.size());
  for (auto y = static_cast<std::size_t>(picture.size_px.y); y-- > 0;) {
    for (std::size_t x = 0; x < width; ++x) {
      const glm::vec3& pixel = picture.radiance[y * width + x];
      texels.insert(texels.end(), {pixel.x, pixel.y, pixel.z, 1.0F});
    }
  }
  gl::Texture2D texture(GL_RGBA32F, picture.size_px);
  texture.Upload(GL_RGBA, GL_FLOAT, texels.data());
  return texture;
}

picture::LinearPicture PictureOf(const gl::Texture2D& linear) {
  const std::vector<float> values = ReadLinear(linear);
  picture::LinearPicture picture{linear.Size(), {}};
  const auto width = static_cast<std::size_t>(picture.size_px.x);
  for (auto y = static_cast<std::size_t>(picture.size_px.y); y-- > 0;) {
    for (std::size_t x = 0; x < width; ++x) {
      const float* pixel = &values[4 * (y * width + x)];
      picture.radiance.emplace_back(pixel[0], pixel[1], pixel[2]);
    }
  }
  return picture;
}

}  // namespace thunderhead::frame
