// The last stage on the device: exposure, tone map and read-back of a linear frame. Owns GL
// objects: use it on the context's thread. Knows no storms.
#pragma once

#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "gl/objects.h"
#include "gl/program.h"
#include "gl/whole_target.h"
#include "picture/linear_picture.h"
#include "scene/scene.h"

namespace thunderhead::frame {

// 8-bit sRGB, three bytes a pixel, rows from top to bottom.
struct ToneMapped {
  std::vector<std::uint8_t> rgb;
  double tone_ms = 0.0;
  double read_back_ms = 0.0;
};

// Factor of radiance at an exposure of 0 EV: a sunlit white cloud, about 0.25 of the sun's
// irradiance, is then bright but not overexposed.
inline constexpr float kExposureAtZeroEv = 6.0F;

class ToneMapper {
 public:
  absl::StatusOr<ToneMapped> Map(const gl::Texture2D& linear, const scene::Display& display);

 private:
  gl::ProgramCache programs_;
  gl::WholeTarget whole_target_;
  gl::Texture2D display_;
  gl::Framebuffer target_;
};

// The texture's values, four floats a pixel, rows from bottom to top as GL keeps them.
std::vector<float> ReadLinear(const gl::Texture2D& linear);

// A linear frame in the renderers' texture format, and back.
gl::Texture2D TextureOf(const picture::LinearPicture& picture);
picture::LinearPicture PictureOf(const gl::Texture2D& linear);

}  // namespace thunderhead::frame
