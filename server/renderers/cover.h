// Which pixels of a picture a storm may cover: the tiles that its occupied bricks project to. The
// passes that look for the storm draw there only, and what is cheaper without it draws elsewhere.
// On the device the tiles are a depth buffer, so that the test is done before any shader runs.
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

// Boxes of one size.
struct Boxes {
  std::vector<glm::dvec3> middles_m;
  glm::dvec3 half_extent_m{0.0};
};

using gl::Around;
using gl::PixelRect;

// Where boxes of one size are seen in a picture of `size_px`, with `margin_px` around.
class BoxProjection {
 public:
  // `view` must outlive it.
  BoxProjection(const glm::dvec3& half_extent_m, const scene::View& view, const glm::ivec2& size_px,
                double margin_px);

  // Nothing for a box behind the eye, the whole picture for one around or beside it.
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
  glm::dvec3 half_m_;  // along the view's axes
};

// Rectangles that do not overlap and hold every pixel that meets one of `boxes`, with `margin_px`
// around.
std::vector<PixelRect> CoveredRects(const Boxes& boxes, const scene::View& view,
                                    const glm::ivec2& size_px, double margin_px);

class Cover {
 public:
  explicit Cover(std::shared_ptr<gl::ProgramCache> programs) : programs_(std::move(programs)) {}

  absl::Status Draw(const Boxes& boxes, const scene::View& view, const glm::ivec2& size_px,
                    double margin_px);

  // The depth attachment of targets that are to be limited; a new texture when the size changes.
  const gl::Texture2D& Depth() const { return depth_; }
  std::size_t Bytes() const { return depth_.Bytes(); }

 private:
  std::shared_ptr<gl::ProgramCache> programs_;
  gl::Texture2D depth_;
  gl::Framebuffer target_;
};

// A picture that a cover may limit.
class CoveredTarget {
 public:
  // `cover`, if any, is of this size. With distances, a second colour attachment holds one float a
  // pixel.
  void Resize(GLenum format, const glm::ivec2& size_px, const Cover* cover,
              bool with_distances = false);
  const gl::Texture2D& Texture() const { return texture_; }
  const gl::Texture2D& Distances() const { return distances_; }
  const gl::Framebuffer& Target() const { return target_; }

 private:
  gl::Texture2D texture_;
  gl::Texture2D distances_;
  GLenum format_ = 0;
  GLuint depth_ = 0;  // the cover's
  gl::Framebuffer target_;
};

enum class Where { kCovered, kElsewhere };

// While it lives, drawing is limited to this part of covered targets; without a cover it is not.
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
