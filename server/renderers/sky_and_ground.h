// The surroundings of a storm: sky and ground, which light it and stand behind it, and the air in
// front of it. Keeps results that depend on the sun and the air until these change. Owns GL
// objects: use it on the context's thread.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "gl/objects.h"
#include "gl/program.h"
#include "gl/whole_target.h"
#include "physics/sky.h"
#include "renderers/air_shade.h"
#include "renderers/ground.h"
#include "renderers/ground_cover.h"
#include "renderers/render_settings.h"
#include "renderers/sun_glow.h"
#include "scene/scene.h"
#include "scene/view.h"
#include "volume/visible_box.h"

namespace thunderhead::renderers {

class SkyAndGround {
 public:
  explicit SkyAndGround(std::shared_ptr<gl::ProgramCache> programs)
      : programs_(std::move(programs)), air_shade_(programs_) {}

  // Brings the sky up to date with the scene's sun and air, the ground's height and the eye's. Call
  // it before the others.
  void Update(const scene::Scene& scene, const scene::View& view, const Ground& ground);

  // As the eye of `view` sees it through the air.
  SunGlow::Sun SunFrom(const scene::Scene& scene, const scene::View& view) const;

  Illumination IlluminationOf(const scene::Scene& scene) const;

  // The light of sky and ground on a white surface, as LightMapOf gives it.
  std::vector<glm::vec3> LightMap(const scene::Scene& scene) const;

  // Finds what share of the sky `medium` hides, unless it is known.
  absl::Status HideSky(const scene::Scene& scene, const Ground& ground,
                       const ResidentMedium& medium) {
    return air_shade_.HideSky(medium, scene, ground.Lowest_m());
  }
  // Sets the uniforms and the texture of common/sky_hidden.glsl; HideSky comes first.
  void BindSkyHidden(const gl::Program& program, const scene::View& view) const {
    air_shade_.BindSkyHidden(program, view);
  }

  // Air and skylight without a storm's shadow.
  void LightAllAir() { air_shade_.Clear(); }
  // Shades them by what is in `box`, whose shadow the ground has, as finely as suits a picture of
  // `size_px`; `medium` may be empty.
  absl::Status ShadeAir(const scene::Scene& scene, const scene::View& view, const Ground& ground,
                        const volume::WorldBox& box, const ResidentMedium& medium,
                        const glm::ivec2& size_px);

  // The eye buffer, drawn before sky and ground.
  struct Front {
    const gl::Texture2D& eye;                    // as Technique::Eye
    const gl::Texture2D* distances_m = nullptr;  // as Technique::Distances_m
    volume::WorldBox box;                        // around it; may be empty
  };
  // Draws `front` in front of sky and covered ground, all through the air, to `target`. `cover`, if
  // any, is the target's: nothing was drawn beyond it. With `chosen`, if any, for these rays.
  absl::Status Composite(const scene::Scene& scene, const scene::View& view, const Ground& ground,
                         const GroundCover& ground_cover, const Front& front,
                         const CoveredTarget& target, const Cover* cover, const ChosenRays* chosen);

  std::size_t Bytes() const {
    return sky_table_.Bytes() + ground_sky_table_.Bytes() + air_shade_.Bytes();
  }

 private:
  void SetEyeSky(double altitude_m);
  // The sky that water reflects.
  void BindGroundSky();
  // The sky's table from one of the heights that it is computed for.
  const std::vector<glm::vec4>& TableOfStep(int step);
  glm::vec3 AroundSun(const glm::vec3& sun) const;  // of `sky_`, which is turned to it
  void BindAir(const gl::Program& program, const scene::Scene& scene, const scene::View& view,
               const Ground& ground, const volume::WorldBox& box) const;

  // Inputs of the sky's light; with the sun's azimuth it only turns.
  struct Key {
    double sun_sine = 0.0;  // of its elevation
    double turbidity = 0.0;
    double ground_albedo = 0.0;
    double ground_m = 0.0;

    bool operator==(const Key&) const = default;
  };

  std::shared_ptr<gl::ProgramCache> programs_;
  gl::WholeTarget whole_target_;
  std::optional<physics::Atmosphere> atmosphere_;
  std::optional<physics::ClearSky> sky_;  // from the ground
  physics::SkyLight sky_light_;
  Key drawn_;
  glm::dvec3 towards_sun_{0.0, 0.0, 1.0};
  std::optional<glm::vec3> around_sun_;           // of Illumination, for a sun of irradiance 1
  std::map<int, std::vector<glm::vec4>> tables_;  // by step
  double eye_height_m_ = -1.0;                    // that the table on the device is for
  gl::Texture2D sky_table_;
  bool ground_sky_is_new_ = false;
  gl::Texture2D ground_sky_table_;
  AirShade air_shade_;
};

}  // namespace thunderhead::renderers
