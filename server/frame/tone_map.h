// The last stage on the device: exposure, white balance, tone map and read-back of a linear frame.
// Owns GL objects: use it on the context's thread.
#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "frame/fine_image.h"
#include "frame/pixel_reader.h"
#include "frame/white_balance.h"
#include "gl/objects.h"
#include "gl/pieces.h"
#include "gl/program.h"
#include "gl/whole_target.h"
#include "picture/linear_picture.h"
#include "scene/scene.h"

namespace thunderhead::frame {

// 8-bit sRGB, three bytes a pixel, rows from top to bottom.
struct ToneMapped {
  std::vector<std::uint8_t> rgb;
  double exposure_ev = 0.0;
  double tone_ms = 0.0;
  double read_back_ms = 0.0;
};

// Factor of radiance at an exposure of 0 EV.
inline constexpr float kExposureAtZeroEv = 6.0F;
// Exposed luminance that the film's curve shows just below white, at 0.9 of it; its contrast leaves
// it as it is.
inline constexpr float kJustBelowWhite = 0.935F;

class ToneMapper {
 public:
  // Programs are linked in `programs`.
  explicit ToneMapper(
      std::shared_ptr<gl::ProgramCache> programs = std::make_shared<gl::ProgramCache>())
      : programs_(std::move(programs)) {}

  // Maps `linear`, a picture of `scene` with the storm's opacity in alpha.
  absl::StatusOr<ToneMapped> Map(const gl::Texture2D& linear, const scene::Scene& scene);

  // Sets the tone of what MapFine maps from now on: the exposure, whose EV it returns, the white
  // balance and the curve of `linear`, a picture of `scene`, without mapping it. Map does it too.
  absl::StatusOr<double> SetTone(const gl::Texture2D& linear, const scene::Scene& scene);

  // A picture with the tone set last.
  absl::StatusOr<FineImage> MapFine(const gl::Texture2D& linear);
  // Its lower left part of that size.
  absl::StatusOr<FineImage> MapFine(const gl::Texture2D& linear, const glm::ivec2& part_px);

  // In which it draws.
  gl::Pieces& Pieces() const { return programs_->Pieces(); }

 private:
  // Factors for radiance, and the curve.
  struct Tone {
    glm::vec3 gain{1.0F};
    bool filmic = true;
  };
  // Where a picture of one depth is drawn to.
  struct Display {
    gl::Texture2D texture;
    gl::Framebuffer target;

    void Resize(GLenum format, const glm::ivec2& size_px);
  };

  // Draws the lower left part of that size there; `display` is at least as large.
  absl::Status Draw(const gl::Texture2D& linear, const glm::ivec2& part_px, bool noise,
                    const Display& display);
  absl::StatusOr<FineImage> MapFineTo(const Display& display, const gl::Texture2D& linear,
                                      const glm::ivec2& part_px);
  // The factor for radiance of the given balance.
  absl::StatusOr<float> ExposureOf(const gl::Texture2D& linear, const scene::Display& display,
                                   const glm::vec3& balance, const WhiteCard& card);

  WhiteCards white_cards_;
  std::shared_ptr<gl::ProgramCache> programs_;
  gl::WholeTarget whole_target_;
  PixelReader pixels_;
  gl::Texture2D brightest_;
  Tone tone_;
  Display display_;
  Display fine_display_;
  Display part_display_;  // only grows, as parts are of all sizes
};

// The texture's values, four floats a pixel, rows from bottom to top as GL keeps them; some rows in
// each piece.
absl::StatusOr<std::vector<float>> ReadLinear(const gl::Texture2D& linear, gl::Pieces& pieces);
std::vector<float> ReadLinear(const gl::Texture2D& linear);  // in one piece

// A linear frame in the renderers' texture format, and back. A picture of unknown opacity counts
// as all storm.
gl::Texture2D TextureOf(const picture::LinearPicture& picture);
absl::StatusOr<picture::LinearPicture> PictureOf(const gl::Texture2D& linear, gl::Pieces& pieces);
picture::LinearPicture PictureOf(const gl::Texture2D& linear);

}  // namespace thunderhead::frame
