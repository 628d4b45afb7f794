// Air that the storm shades: the light that is missing from what the air sends to the eye, on each
// ray of a coarse picture up to each of a number of distances. The sun is shaded as the ground is
// (common/storm_shadow.glsl). Light that the air has scattered before reaches a place from the part
// of the sky that the storm leaves open. From the part that it hides, a place gets the light of a
// layer of the storm's depth in its shadow; elsewhere what the storm's faces reflect there, more on
// the sun's side. The part of the sky that the storm hides is found once for a medium.
// Owns GL objects: use it on the context's thread.
#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "gl/objects.h"
#include "gl/program.h"
#include "physics/atmosphere.h"
#include "renderers/ground.h"
#include "renderers/medium.h"
#include "scene/scene.h"
#include "scene/shaded_air.h"
#include "scene/view.h"
#include "volume/visible_box.h"

namespace thunderhead::renderers {

class AirShade {
 public:
  explicit AirShade(std::shared_ptr<gl::ProgramCache> programs) : programs_(std::move(programs)) {}

  // Takes the light of the air by height, for a sun whose elevation has this sine; `sky_irradiance`
  // is that of the clear sky on the ground, for a sun of irradiance 1.
  void SetLight(const physics::Atmosphere& atmosphere, double sun_sine,
                const glm::vec3& sky_irradiance);

  // Finds how much of the sky `medium` hides, unless it is known. An empty medium hides nothing.
  absl::Status HideSky(const ResidentMedium& medium, const scene::Scene& scene, double ground_m);

  // Finds the missing light for a view, under the shadow that `ground` has. `box` is around what
  // casts it; `picture_px` is the size of the picture that it is to suit. SetLight and HideSky come
  // first.
  absl::Status Cast(const scene::Scene& scene, const scene::View& view, const Ground& ground,
                    const volume::WorldBox& box, const glm::ivec2& picture_px);
  // Nothing is missing.
  void Clear() { present_ = false; }
  bool Present() const { return present_; }

  // Sets the uniforms and textures of common/air_shade.glsl and common/sky_hidden.glsl, for
  // coordinates from the eye.
  void Bind(const gl::Program& program, const scene::View& view) const;

  // Those of common/sky_hidden.glsl alone but faces_sunlight; HideSky comes first.
  void BindSkyHidden(const gl::Program& program, const scene::View& view) const;

  std::size_t Bytes() const {
    return light_.Bytes() + sky_hidden_.Bytes() + storm_faces_.Bytes() + shade_.Bytes();
  }

 private:
  // Distances along the rays between which air is shaded.
  void SetDistances(const scene::View& view, const scene::ShadedAir& air);

  std::shared_ptr<gl::ProgramCache> programs_;
  bool present_ = false;
  gl::Texture2D light_;
  // Of sunlight of irradiance 1.
  glm::vec3 level_irradiance_{0.0F};
  glm::vec3 level_skylight_{0.0F};
  std::vector<glm::vec3> sunlight_;  // by height
  glm::vec3 faces_sunlight_{0.0F};   // of the scene's sun, at the middle of the storm's height
  gl::Texture3D sky_hidden_;
  gl::Texture3D storm_faces_;
  std::uint64_t hidden_by_ = 0;  // ResidentMedium::Id
  scene::MediumSettings hidden_settings_;
  volume::WorldBox hidden_box_;
  gl::Texture3D shade_;
  double near_m_ = 0.0;
  double far_m_ = 1.0;
};

}  // namespace thunderhead::renderers
