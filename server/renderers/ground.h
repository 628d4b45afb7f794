// The ground under a storm: where view rays meet it, and the storm's shadow on it. Level ground is
// a plane (or the round Earth's surface) and costs next to nothing; terrain is a height map that
// rays are marched over. Owns GL objects: use it on the context's thread.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <utility>

#include "absl/status/status.h"
#include "gl/objects.h"
#include "gl/program.h"
#include "gl/whole_target.h"
#include "renderers/light_frame.h"
#include "renderers/medium.h"
#include "renderers/render_settings.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::renderers {

// The variant of common/ground.glsl.
struct GroundVariant {
  gl::DefineValue relief;  // terrain that is not level

  gl::Defines Defines() const { return {{"RELIEF", relief}}; }
};

class Ground {
 public:
  explicit Ground(std::shared_ptr<gl::ProgramCache> programs) : programs_(std::move(programs)) {}

  // Takes the terrain of these fields.
  void SetTerrain(const volume::HydrometeorFields& fields);

  // Computes the shadow of `medium`, if it is not empty, under the settings' sun.
  absl::Status CastShadow(const ResidentMedium& medium, const RenderSettings& settings);
  // Takes the shadow of something else, as common/storm_shadow.glsl has it, over `frame` around
  // `middle_m`.
  void TakeShadow(gl::Texture2D shadow, const LightFrame& frame, const glm::dvec3& middle_m);
  // The same of a texture that stays the caller's and is there as long as it is drawn.
  void ShareShadow(const gl::Texture2D* shadow, const LightFrame& frame,
                   const glm::dvec3& middle_m);
  void ClearShadow() { has_shadow_ = false; }
  bool HasShadow() const { return has_shadow_; }
  // Puts a correction's ground on the device unless it is there; null is none.
  void SetCorrection(const std::shared_ptr<const LightCorrection>& correction);
  // True if there is one.
  bool Corrected() const { return correction_ != nullptr; }

  // Height of its lowest point above sea level.
  double Lowest_m() const { return lowest_m_; }
  GroundVariant Variant() const { return {.relief = relief_}; }
  // True if ground may stand between the eye and a storm. Level ground falls away from below the
  // storm, so that it hides nothing from an eye above the world's plane.
  bool MayHide(const scene::View& view) const {
    return relief_ || (view.ground_curvature_per_m > 0.0 && view.eye_m.z < lowest_m_);
  }

  // Distance of the ground along each pixel's ray, where rays through media end; or along each
  // chosen one, for a picture of their size.
  absl::Status DrawDistance(const scene::View& view, const glm::ivec2& size,
                            const ChosenRays* chosen = nullptr);
  const gl::Texture2D& Distance() const { return distances_[drawn_distance_].distance_m; }

  // Sets the uniforms and textures of common/ground.glsl for coordinates from the eye.
  void Bind(const gl::Program& program, const scene::View& view) const;
  // Sets those of common/storm_shadow.glsl.
  void BindShadow(const gl::Program& program, const scene::View& view) const;
  // Sets those of a correction, if there is one.
  void BindCorrection(const gl::Program& program, const scene::View& view) const;

  std::size_t Bytes() const {
    return terrain_.Bytes() + shadow_.Bytes() + skylight_factor_.Bytes() +
           distances_[0].distance_m.Bytes() + distances_[1].distance_m.Bytes();
  }

 private:
  void PlaceShadow(const LightFrame& frame, const glm::dvec3& middle_m);

  std::shared_ptr<gl::ProgramCache> programs_;
  gl::WholeTarget whole_target_;
  volume::RegularGrid grid_;
  bool relief_ = false;
  double lowest_m_ = 0.0;
  double highest_m_ = 0.0;
  double steepest_ = 0.0;
  gl::Texture2D terrain_;

  bool has_shadow_ = false;
  const gl::Texture2D* shared_shadow_ = nullptr;  // in place of shadow_
  gl::Texture2D shadow_;
  gl::Framebuffer shadow_target_;
  glm::dvec3 shadow_middle_m_{0.0};
  glm::dvec3 shadow_right_{0.0};  // 1 across its half width
  glm::dvec3 shadow_up_{0.0};
  glm::dvec3 shadow_down_{0.0};  // 1 across its half depth, away from the sun

  std::shared_ptr<const LightCorrection> correction_;
  gl::Texture2D skylight_factor_;

  struct Distances {
    gl::Texture2D distance_m;
    gl::Framebuffer target;
  };
  std::array<Distances, 2> distances_;  // the second is for chosen rays
  std::size_t drawn_distance_ = 0;      // last
};

}  // namespace thunderhead::renderers
