// Bookkeeping for light that changes little as the sun moves. The cells are divided into kCount
// parts. If the parts are updated in turns, each update computes one part, and the others keep
// their light. The class is a plain value and does not use GL.
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
  // A part is updated if the sun is farther than this angle from the sun of the part's last update.
  static constexpr double kFarthest_deg = 10.0;
  using Parts = std::bitset<kCount>;

  // Returns the parts to update for a sun in the unit direction `towards_sun`. If `in_turns` is
  // false, it returns all parts. Otherwise it returns the next part, and the parts whose last sun
  // was too far away. It also returns all parts if the sun has not moved, because then another
  // input has changed.
  Parts Next(const glm::dvec3& towards_sun, bool in_turns) const;

  // Records that `parts` have been updated.
  void Found(const Parts& parts, const glm::dvec3& towards_sun);

  // Marks all parts as outdated.
  void Forget() { suns_ = {}; }

 private:
  // The sun's direction at each part's last update.
  std::array<std::optional<glm::dvec3>, kCount> suns_;
  std::optional<glm::dvec3> last_sun_;
  std::size_t turn_ = 0;
};

}  // namespace thunderhead::renderers
