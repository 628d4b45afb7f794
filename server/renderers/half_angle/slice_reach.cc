#include "renderers/half_angle/slice_reach.h"

#include <algorithm>
#include <cmath>

#include "glm/common.hpp"
#include "glm/geometric.hpp"

namespace thunderhead::renderers {
namespace {

constexpr double kMarginPx = 1.0;

// Computes which texels of the light buffer are shaded by boxes of one size.
class Shadow {
 public:
  Shadow(const glm::dvec3& half_extent_m, const LightFrame& frame, const glm::ivec2& size)
      : frame_(frame),
        size_(size),
        half_m_(glm::dot(glm::abs(frame.right), half_extent_m),
                glm::dot(glm::abs(frame.up), half_extent_m)) {}

  PixelRect Of(const glm::dvec3& local_m) const {
    const glm::dvec2 across_m(glm::dot(local_m, frame_.right), glm::dot(local_m, frame_.up));
    return {Texel(glm::floor(TexelsOf(across_m - half_m_)) - 1.0),
            Texel(glm::ceil(TexelsOf(across_m + half_m_)) + 1.0)};
  }

 private:
  glm::dvec2 TexelsOf(const glm::dvec2& across_m) const {
    return (0.5 * across_m / frame_.half_extent_m + 0.5) * glm::dvec2(size_);
  }
  glm::ivec2 Texel(const glm::dvec2& place) const {
    return glm::clamp(glm::ivec2(place), glm::ivec2(0), size_);
  }

  const LightFrame& frame_;
  glm::ivec2 size_;
  glm::dvec2 half_m_;  // half extent of a box along the frame's axes
};

}  // namespace

std::vector<SliceReach> ReachOf(const Slicing& slicing, const Boxes& boxes,
                                const glm::dvec3& middle_m, const scene::View& view,
                                const glm::ivec2& eye_px, const LightFrame& frame,
                                const glm::ivec2& light_texels) {
  std::vector<SliceReach> reach(static_cast<std::size_t>(slicing.count));
  if (reach.empty()) return reach;
  const BoxProjection projection(boxes.half_extent_m, view, eye_px, kMarginPx);
  const Shadow shadow(boxes.half_extent_m, frame, light_texels);
  const double half_m = glm::dot(glm::abs(slicing.normal), boxes.half_extent_m);
  const double last = static_cast<double>(reach.size()) - 1.0;
  for (const glm::dvec3& box_m : boxes.middles_m) {
    const glm::dvec3 local_m = box_m - middle_m;
    const double below_m = slicing.first_m - glm::dot(slicing.normal, local_m);
    const auto low = static_cast<std::size_t>(
        std::clamp(std::ceil((below_m - half_m) / slicing.spacing_m), 0.0, last + 1.0));
    const auto end = static_cast<std::size_t>(
        std::clamp(std::floor((below_m + half_m) / slicing.spacing_m), -1.0, last) + 1.0);
    if (low >= end) continue;
    const PixelRect in_light = shadow.Of(local_m);
    const PixelRect in_eye = projection.Of(box_m).value_or(PixelRect());
    for (std::size_t i = low; i < end; ++i) {
      reach[i].light = Around(reach[i].light, in_light);
      reach[i].eye = Around(reach[i].eye, in_eye);
    }
  }
  return reach;
}

}  // namespace thunderhead::renderers
