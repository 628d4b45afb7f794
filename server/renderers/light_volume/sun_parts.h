// Bookkeeping for light that changes little as the sun moves. It is updated for one part of the
// cells at a time, and kept for the others. The class is a plain value and does not use GL.
#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <optional>

#include "glm/vec3.hpp"

namespace thunderhead::renderers {

class SunParts {
 public:
  static constexpr std::size_t kCount = 8;
  // A part is updated if the sun is farther than this from the sun of its last update.
  static constexpr double kFarthest_deg = 10.0;
  using Parts = std::bitset<kCount>;

  // Returns the parts to update for a sun in direction `towards_sun`, of length 1. Without
  // `in_turns` it returns all parts. With `in_turns` it returns the next part, and those whose last
  // sun was too far away. It also returns all parts if the sun has not moved, because something
  // else has changed.
  Parts Next(const glm::dvec3& towards_sun, bool in_turns) const;

  // Records that `parts` have been updated.
  void Found(const Parts& parts, const glm::dvec3& towards_sun);

  // Marks all parts as outdated.
  void Forget() { suns_ = {}; }

 private:
  std::array<std::optional<glm::dvec3>, kCount> suns_;  // the sun of each part's last update
  std::optional<glm::dvec3> last_sun_;
  std::size_t turn_ = 0;
};

}  // namespace thunderhead::renderers
