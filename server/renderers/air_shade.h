// The air that the storm shades. For each ray of a coarse picture, the class computes how much
// light the storm removes from the air's radiance up to each of several distances. The storm's
// shadow in the air comes from the same texture as its shadow on the ground
// (common/storm_shadow.glsl).
//
// The air also scatters light that the air has already scattered (skylight). A place gets skylight
// from the part of the sky that the storm leaves open. From the hidden part, a place in the storm's
// shadow gets the light that would pass through a level layer with the storm's optical depth. A
// place outside the shadow gets the light that the storm's faces reflect, which is brighter on the
// sun's side. The hidden part of the sky is computed once for a medium.
//
// The class owns GL objects, so use it on the context's thread.
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

  // Sets the light that the air receives at each height. The sine of the sun's elevation is
  // `sun_sine`. For a sun of irradiance 1, the irradiance of the clear sky on the ground is
  // `sky_irradiance`.
  void SetLight(const physics::Atmosphere& atmosphere, double sun_sine,
                const glm::vec3& sky_irradiance);

  // Computes how much of the sky `medium` hides, unless the result for this medium is kept. An
  // empty medium hides nothing.
  absl::Status HideSky(const ResidentMedium& medium, const scene::Scene& scene, double ground_m);

  // Computes how much light the storm removes on the rays of a view, using the storm's shadow in
  // `ground`. The object that casts the shadow is inside `box`. The resolution suits a picture of
  // the size `picture_px`. Call SetLight and HideSky first.
  absl::Status Cast(const scene::Scene& scene, const scene::View& view, const Ground& ground,
                    const volume::WorldBox& box, const glm::ivec2& picture_px);
  // Removes all shade.
  void Clear() { present_ = false; }
  bool Present() const { return present_; }

  // Sets the uniforms and textures of common/air_shade.glsl and common/sky_hidden.glsl, for
  // coordinates relative to the eye.
  void Bind(const gl::Program& program, const scene::View& view) const;

  // Sets only the uniforms and textures of common/sky_hidden.glsl, without faces_sunlight. Call
  // HideSky first.
  void BindSkyHidden(const gl::Program& program, const scene::View& view) const;

  std::size_t Bytes() const {
    return light_.Bytes() + sky_hidden_.Bytes() + storm_faces_.Bytes() + shade_.Bytes();
  }

 private:
  // Sets the distances along the rays between which air is shaded.
  void SetDistances(const scene::View& view, const scene::ShadedAir& air);

  std::shared_ptr<gl::ProgramCache> programs_;
  bool present_ = false;
  gl::Texture2D light_;
  // Irradiance on level ground, for sunlight of irradiance 1. level_irradiance_ is that of sun and
  // sky, level_skylight_ that of the sky alone.
  glm::vec3 level_irradiance_{0.0F};
  glm::vec3 level_skylight_{0.0F};
  std::vector<glm::vec3> sunlight_;  // irradiance of sunlight by height
  glm::vec3 faces_sunlight_{0.0F};   // irradiance of the scene's sun at half the storm's height
  gl::Texture3D sky_hidden_;
  gl::Texture3D storm_faces_;
  // ResidentMedium::Id of the medium for which sky_hidden_ was computed
  std::uint64_t hidden_by_ = 0;
  scene::MediumSettings hidden_settings_;
  volume::WorldBox hidden_box_;
  gl::Texture3D shade_;
  double near_m_ = 0.0;
  double far_m_ = 1.0;
};

}  // namespace thunderhead::renderers
