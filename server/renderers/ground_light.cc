#include "renderers/ground_light.h"

#include <algorithm>
#include <vector>

#include "base/status.h"
#include "glm/common.hpp"
#include "scene/view.h"
#include "shaders/bindings.h"
#include "shaders/uniforms.h"

namespace thunderhead::renderers {
namespace {

constexpr double kTexel_m = 250.0;  // minimum size of a texel
constexpr int kMaxTexels = 192;     // maximum number of texels along each side
// Maximum size of a texel. A cloud base receives little light from ground farther away than this.
// Larger texels could not separate the ground below a base from its surroundings.
constexpr double kCoarsest_m = 2000.0;

}  // namespace

absl::StatusOr<LitGround> GroundLight::Find(const Ground& ground, const SkyAndGround& surroundings,
                                            const volume::WorldBox& storm,
                                            const Illumination& light) {
  // The margin is the height of the storm's top above the lowest ground. Ground farther from the
  // storm's box counts as open.
  const glm::dvec2 margin_m(storm.high_m.z - ground.Lowest_m());
  const glm::dvec2 low_m = glm::dvec2(storm.low_m) - margin_m;
  const glm::dvec2 size_m = glm::dvec2(storm.high_m) + margin_m - low_m;
  const glm::ivec3 size(
      glm::clamp(glm::ivec2(size_m / kTexel_m), glm::ivec2(1), glm::ivec2(kMaxTexels)), 1);
  if (std::max(size_m.x / size.x, size_m.y / size.y) > kCoarsest_m) return LitGround();
  if (map_.Size() != size) map_ = gl::Texture3D(GL_RG32F, size);
  THUNDERHEAD_ASSIGN_OR_RETURN(
      const gl::Program* program,
      programs_->Get(gl::ProgramSource::Compute("ground/light.comp", ground.Variant().Defines())));
  const scene::View from_origin;
  ground.Bind(*program, from_origin);
  ground.BindShadow(*program, from_origin);
  surroundings.BindSkyHidden(*program, from_origin);
  program->Set(uniform::point_count, size);
  program->Set(uniform::lattice_low_m, glm::vec3(low_m, 0.0));
  program->Set(uniform::lattice_size_m, glm::vec3(size_m, 1.0));
  const auto sine = static_cast<float>(light.towards_sun.z);
  program->Set(uniform::towards_sun, glm::vec3(light.towards_sun));
  program->Set(uniform::faces_sunlight, glm::vec3(sine > 0.0F ? light.ground_sunlit / sine : 0.0F));
  program->Set(uniform::sunlit_share, light.ground_sunlit);
  program->Set(uniform::mean_albedo, light.ground_albedo);
  map_.BindImage(shaders::kGroundLightImage, GL_WRITE_ONLY);
  program->Use();
  const glm::ivec3 groups = (size + shaders::kLightGroupSide - 1) / shaders::kLightGroupSide;
  glDispatchCompute(static_cast<GLuint>(groups.x), static_cast<GLuint>(groups.y), 1);
  const std::size_t count = static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y);
  std::vector<float> texels(2 * count);
  map_.Download(GL_RG, GL_FLOAT, texels.size() * sizeof(float), texels.data());
  THUNDERHEAD_RETURN_IF_ERROR(programs_->Pieces().Between());
  GroundMap map{glm::ivec2(size), low_m, size_m / glm::dvec2(size), {}, {}};
  for (std::size_t i = 0; i < count; ++i) {
    map.share.push_back(texels[2 * i]);
    map.height_m.push_back(texels[2 * i + 1]);
  }
  return LitGround(std::move(map));
}

}  // namespace thunderhead::renderers
