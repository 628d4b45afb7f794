#include "renderers/light_volume/sun_parts.h"

#include <cmath>

#include "glm/geometric.hpp"
#include "glm/trigonometric.hpp"

namespace thunderhead::renderers {

SunParts::Parts SunParts::Next(const glm::dvec3& towards_sun, bool in_turns) const {
  Parts parts;
  if (!in_turns || last_sun_ == towards_sun) return parts.set();
  const double nearest = std::cos(glm::radians(kFarthest_deg));
  for (std::size_t part = 0; part < kCount; ++part) {
    const std::optional<glm::dvec3>& sun = suns_[part];
    parts[part] = part == turn_ || !sun.has_value() || glm::dot(*sun, towards_sun) < nearest;
  }
  return parts;
}

void SunParts::Found(const Parts& parts, const glm::dvec3& towards_sun) {
  for (std::size_t part = 0; part < kCount; ++part) {
    if (parts[part]) suns_[part] = towards_sun;
  }
  last_sun_ = towards_sun;
  turn_ = (turn_ + 1) % kCount;
}

}  // namespace thunderhead::renderers
