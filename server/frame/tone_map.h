// The last stage on the device: exposure, white balance, tone map and read-back of a linear frame.
// It owns GL objects, so use it on the context's thread.
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

// Factor that multiplies radiance at an exposure of 0 EV.
inline constexpr float kExposureAtZeroEv = 6.0F;
// The exposed luminance that the film curve maps to 0.9 of white, just below white. The contrast of
// the curve does not change this luminance.
inline constexpr float kJustBelowWhite = 0.935F;

class ToneMapper {
 public:
  // The mapper gets its linked shader programs from `programs`.
  explicit ToneMapper(
      std::shared_ptr<gl::ProgramCache> programs = std::make_shared<gl::ProgramCache>())
      : programs_(std::move(programs)) {}

  // Maps `linear`, a linear picture of `scene` with the storm's opacity in alpha.
  absl::StatusOr<ToneMapped> Map(const gl::Texture2D& linear, const scene::Scene& scene);

  // Sets the tone for later calls of MapFine without mapping a picture. The tone consists of
  // exposure, white balance and curve. It is derived from `linear`, a picture of `scene`. Returns
  // the exposure in EV. Map also sets the tone.
  absl::StatusOr<double> SetTone(const gl::Texture2D& linear, const scene::Scene& scene);

  // Maps a picture with the tone that Map or SetTone set last.
  absl::StatusOr<FineImage> MapFine(const gl::Texture2D& linear);
  // Maps only the lower left part of the picture, of the size `part_px`.
  absl::StatusOr<FineImage> MapFine(const gl::Texture2D& linear, const glm::ivec2& part_px);

  // Returns the pieces (gl/pieces.h) in which the mapper draws.
  gl::Pieces& Pieces() const { return programs_->Pieces(); }

 private:
  // Factors that multiply red, green and blue radiance, and whether the film curve is used.
  struct Tone {
    glm::vec3 gain{1.0F};
    bool filmic = true;
  };
  // The render target for pictures of one bit depth.
  struct Display {
    gl::Texture2D texture;
    gl::Framebuffer target;

    void Resize(GLenum format, const glm::ivec2& size_px);
  };

  // Draws the lower left part of the size `part_px` to `display`, which must be at least as large.
  absl::Status Draw(const gl::Texture2D& linear, const glm::ivec2& part_px, bool noise,
                    const Display& display);
  absl::StatusOr<FineImage> MapFineTo(const Display& display, const gl::Texture2D& linear,
                                      const glm::ivec2& part_px);
  // Returns the factor that multiplies radiance with the given white balance. It follows from the
  // scene's exposure, or from an automatic exposure if the scene has none.
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
  Display part_display_;  // target for parts; it never shrinks, because parts have various sizes
};

// Returns the texture's values, four floats a pixel, with rows from bottom to top as in GL. The
// first overload reads some rows in each piece.
absl::StatusOr<std::vector<float>> ReadLinear(const gl::Texture2D& linear, gl::Pieces& pieces);
std::vector<float> ReadLinear(const gl::Texture2D& linear);  // reads in one piece

// Convert between a linear picture and a texture in the renderers' format. If a picture's opacity
// is unknown, the texture's opacity is 1.
gl::Texture2D TextureOf(const picture::LinearPicture& picture);
absl::StatusOr<picture::LinearPicture> PictureOf(const gl::Texture2D& linear, gl::Pieces& pieces);
picture::LinearPicture PictureOf(const gl::Texture2D& linear);

}  // namespace thunderhead::frame
