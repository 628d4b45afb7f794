// The surroundings of a storm: the sky and the ground, which light it and form its background, and
// the air in front of it. Results that depend on the sun and the air are kept until these change.
// The class owns GL objects, so use it on the context's thread.
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

  // Updates the sky for the scene's sun and air, and for the heights of the ground and the eye.
  // Call it before the other functions.
  void Update(const scene::Scene& scene, const scene::View& view, const Ground& ground);

  // Returns the sun as the eye of `view` sees it through the air.
  SunGlow::Sun SunFrom(const scene::Scene& scene, const scene::View& view) const;

  Illumination IlluminationOf(const scene::Scene& scene) const;

  // Returns the light of sky and ground on a white surface, from LightMapOf.
  std::vector<glm::vec3> LightMap(const scene::Scene& scene) const;

  // Computes the share of the sky that `medium` hides, unless it is already known.
  absl::Status HideSky(const scene::Scene& scene, const Ground& ground,
                       const ResidentMedium& medium) {
    return air_shade_.HideSky(medium, scene, ground.Lowest_m());
  }
  // Sets the uniforms and the texture of common/sky_hidden.glsl. Call HideSky first.
  void BindSkyHidden(const gl::Program& program, const scene::View& view) const {
    air_shade_.BindSkyHidden(program, view);
  }

  // Removes the effect of the storm's shadow on air and skylight.
  void LightAllAir() { air_shade_.Clear(); }
  // Computes the shade of the object in `box` on air and skylight. The object's shadow must be set
  // in `ground`. The resolution suits a picture of `size_px`. `medium` may be empty.
  absl::Status ShadeAir(const scene::Scene& scene, const scene::View& view, const Ground& ground,
                        const volume::WorldBox& box, const ResidentMedium& medium,
                        const glm::ivec2& size_px);

  // The eye buffer, drawn before sky and ground.
  struct Front {
    const gl::Texture2D& eye;                    // from Technique::Eye
    const gl::Texture2D* distances_m = nullptr;  // from Technique::Distances_m
    volume::WorldBox box;                        // bounding box of what was drawn; may be empty
  };
  // Draws `front`, and behind it the sky and the ground with `ground_cover` (land use, borders,
  // rings), to `target`. All are seen through the air. `cover` marks the pixels of `target` that
  // the storm may cover (cover.h). It is null if the storm may be anywhere. If `chosen` is not
  // null, only these rays are drawn.
  absl::Status Composite(const scene::Scene& scene, const scene::View& view, const Ground& ground,
                         const GroundCover& ground_cover, const Front& front,
                         const CoveredTarget& target, const Cover* cover, const ChosenRays* chosen);

  std::size_t Bytes() const {
    return sky_table_.Bytes() + ground_sky_table_.Bytes() + air_shade_.Bytes();
  }

 private:
  void SetEyeSky(double altitude_m);
  // Binds the table of the sky that water on the ground reflects.
  void BindGroundSky();
  // Returns the sky's table for an eye at the height HeightOfStep(step) above the ground.
  const std::vector<glm::vec4>& TableOfStep(int step);
  // Returns the light of the bright region around the sun. `sky_` must be turned to `sun`.
  glm::vec3 AroundSun(const glm::vec3& sun) const;
  void BindAir(const gl::Program& program, const scene::Scene& scene, const scene::View& view,
               const Ground& ground, const volume::WorldBox& box) const;

  // The inputs of the sky's light. The sun's azimuth is not an input, because it only rotates the
  // light.
  struct Key {
    double sun_sine = 0.0;  // sine of the sun's elevation
    double turbidity = 0.0;
    double ground_albedo = 0.0;
    double ground_m = 0.0;

    bool operator==(const Key&) const = default;
  };

  std::shared_ptr<gl::ProgramCache> programs_;
  gl::WholeTarget whole_target_;
  std::optional<physics::Atmosphere> atmosphere_;
  std::optional<physics::ClearSky> sky_;  // seen from the ground
  physics::SkyLight sky_light_;
  Key drawn_;
  glm::dvec3 towards_sun_{0.0, 0.0, 1.0};
  std::optional<glm::vec3> around_sun_;  // Illumination::around_sun for a sun of irradiance 1
  std::map<int, std::vector<glm::vec4>> tables_;  // tables by step
  double eye_height_m_ = -1.0;                    // eye height of the table on the device
  gl::Texture2D sky_table_;
  bool ground_sky_is_new_ = false;
  gl::Texture2D ground_sky_table_;
  AirShade air_shade_;
};

}  // namespace thunderhead::renderers
