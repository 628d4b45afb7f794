#include "renderers/sunlight.h"

#include <vector>

#include "shaders/bindings.h"
#include "shaders/uniforms.h"

namespace thunderhead::renderers {

void BindSunlight(const gl::Program& program, const Illumination& illumination,
                  double middle_height_m) {
  const std::vector<glm::vec3>& levels = illumination.sunlight_levels;
  program.Set(uniform::sunlight_levels,
              levels.empty()
                  ? std::vector<glm::vec3>(shaders::kSunlightLevels, illumination.sunlight)
                  : levels);
  program.Set(uniform::middle_height_m, static_cast<float>(middle_height_m));
}

}  // namespace thunderhead::renderers
