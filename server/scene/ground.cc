#include "scene/ground.h"

#include "scene/view.h"

namespace thunderhead::scene {
namespace {

constexpr glm::vec3 kGroundTint(1.0F, 0.93F, 0.78F);

}  // namespace

Ground DrawnGround(const Scene& scene, const volume::HydrometeorFields& fields) {
  Ground ground = scene.ground;
  if (ground.cover == GroundCover::kLandUse && fields.land.Empty()) {
    ground.cover = GroundCover::kPlain;
  }
  ground.borders = ground.borders && fields.borders != nullptr;
  return ground;
}

Scene WithGroundOf(Scene scene, const volume::HydrometeorFields& fields) {
  if (DrawnGround(scene, fields).cover == GroundCover::kLandUse) {
    scene.sky.ground_albedo = fields.land.mean_albedo;
  }
  return scene;
}

glm::vec3 PlainReflectance(const Scene& scene) {
  return kGroundTint * static_cast<float>(scene.sky.ground_albedo);
}

glm::dvec2 RingMiddle_m(const volume::HydrometeorFields& fields) {
  return SiteOf(fields, glm::dvec2(0.0)).storm_middle_m;
}

glm::dvec2 TrueNorth(const volume::HydrometeorFields& fields) {
  return glm::dvec2(Direction(fields.true_north_deg, 0.0));
}

}  // namespace thunderhead::scene
