// The pixels of a picture that a storm may cover: the tiles onto which its occupied bricks
// (non-empty blocks of cells) project. Passes that draw the storm run only in these pixels. Cheaper
// passes without the storm draw the other pixels. On the device the tiles are a depth buffer, so
// that the depth test discards pixels before a shader runs.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "absl/status/status.h"
#include "gl/objects.h"
#include "gl/pixel_rect.h"
#include "gl/program.h"
#include "glm/vec2.hpp"
#include "glm/vec3.hpp"
#include "scene/view.h"

namespace thunderhead::renderers {

// Boxes that all have the same size.
struct Boxes {
  std::vector<glm::dvec3> middles_m;
  glm::dvec3 half_extent_m{0.0};
};

using gl::Around;
using gl::PixelRect;

// Projects boxes of one size onto a picture of `size_px`, with a margin of `margin_px`.
class BoxProjection {
 public:
  // `view` must outlive the projection.
  BoxProjection(const glm::dvec3& half_extent_m, const scene::View& view, const glm::ivec2& size_px,
                double margin_px);

  // Returns the pixels that the box around `middle_m` may cover. Returns nothing for a box behind
  // the eye. Returns the whole picture for a box on both sides of the plane through the eye.
  std::optional<PixelRect> Of(const glm::dvec3& middle_m) const;

 private:
  struct Interval {
    double low = 0.0;
    double high = 0.0;
  };

  Interval Across(double middle_m, double half_m, double forward_m, double half_width_m,
                  double tan_half_width, int size_px) const;

  const scene::View& view_;
  glm::ivec2 size_px_;
  double margin_px_;
  glm::dvec3 half_m_;  // half extent along the view's axes
};

// Returns rectangles that do not overlap and that contain every pixel covered by one of `boxes`,
// with a margin of `margin_px`.
std::vector<PixelRect> CoveredRects(const Boxes& boxes, const scene::View& view,
                                    const glm::ivec2& size_px, double margin_px);

class Cover {
 public:
  explicit Cover(std::shared_ptr<gl::ProgramCache> programs) : programs_(std::move(programs)) {}

  absl::Status Draw(const Boxes& boxes, const scene::View& view, const glm::ivec2& size_px,
                    double margin_px);

  // Returns the depth attachment for targets that are limited to the cover. After a change of size
  // it is a new texture.
  const gl::Texture2D& Depth() const { return depth_; }
  std::size_t Bytes() const { return depth_.Bytes(); }

 private:
  std::shared_ptr<gl::ProgramCache> programs_;
  gl::Texture2D depth_;
  gl::Framebuffer target_;
};

// A render target whose drawing can be limited by a cover.
class CoveredTarget {
 public:
  // Resizes the picture. `cover` may be null, otherwise it must have the size `size_px`. If
  // `with_distances` is true, a second colour attachment holds one float a pixel.
  void Resize(GLenum format, const glm::ivec2& size_px, const Cover* cover,
              bool with_distances = false);
  const gl::Texture2D& Texture() const { return texture_; }
  const gl::Texture2D& Distances() const { return distances_; }
  const gl::Framebuffer& Target() const { return target_; }

 private:
  gl::Texture2D texture_;
  gl::Texture2D distances_;
  GLenum format_ = 0;
  GLuint depth_ = 0;  // the cover's depth texture
  gl::Framebuffer target_;
};

enum class Where { kCovered, kElsewhere };

// Limits drawing on covered targets to the pixels inside or outside the cover, for the lifetime of
// the object. If `cover` is null, drawing is not limited.
class LimitedTo {
 public:
  LimitedTo(Where where, const Cover* cover);
  ~LimitedTo();
  LimitedTo(const LimitedTo&) = delete;
  LimitedTo& operator=(const LimitedTo&) = delete;

 private:
  bool limited_;
};

}  // namespace thunderhead::renderers
