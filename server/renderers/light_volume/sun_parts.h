// Light that changes little from one place of the sun to the next, while that moves: found anew for
// one part of the cells at a time, and kept for the others. Plain values; knows no GL.
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
  // The sun has not gone farther than this since any part was found.
  static constexpr double kFarthest_deg = 10.0;
  using Parts = std::bitset<kCount>;

  // Those to find for a sun in direction `towards_sun`, of length 1: all, or, `in_turns`, the next
  // one and those that were found for a sun farther away. All of a sun that has not moved, too, as
  // something else has changed.
  Parts Next(const glm::dvec3& towards_sun, bool in_turns) const;

  // `parts` have been found.
  void Found(const Parts& parts, const glm::dvec3& towards_sun);

  // None has.
  void Forget() { suns_ = {}; }

 private:
  std::array<std::optional<glm::dvec3>, kCount> suns_;  // for which each part was found
  std::optional<glm::dvec3> last_sun_;
  std::size_t turn_ = 0;
};

}  // namespace thunderhead::renderers
