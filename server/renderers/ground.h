// The ground under a storm: its intersection with view rays, and the storm's shadow on it. Level
// ground is a plane (or the round Earth's surface), which costs almost no time. Terrain is a height
// map in which rays are marched. The class owns GL objects, so use it on the context's thread.
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

// Shader variant of common/ground.glsl.
struct GroundVariant {
  gl::DefineValue relief;  // the terrain is not level

  gl::Defines Defines() const { return {{"RELIEF", relief}}; }
};

class Ground {
 public:
  explicit Ground(std::shared_ptr<gl::ProgramCache> programs) : programs_(std::move(programs)) {}

  // Sets the terrain of these fields.
  void SetTerrain(const volume::HydrometeorFields& fields);

  // Computes the shadow of `medium` in the light of the sun of `settings`, if the medium is not
  // empty.
  absl::Status CastShadow(const ResidentMedium& medium, const RenderSettings& settings);
  // Sets the shadow of an object that is not a medium, as a texture in the format of
  // common/storm_shadow.glsl. The texture covers `frame` around `middle_m`.
  void TakeShadow(gl::Texture2D shadow, const LightFrame& frame, const glm::dvec3& middle_m);
  // Uses a shadow texture that the caller owns. The caller must keep the texture as long as the
  // ground is drawn.
  void ShareShadow(const gl::Texture2D* shadow, const LightFrame& frame,
                   const glm::dvec3& middle_m);
  void ClearShadow() { has_shadow_ = false; }
  bool HasShadow() const { return has_shadow_; }
  // Uploads the ground part of `correction` unless it is already on the device. Null removes the
  // correction.
  void SetCorrection(const std::shared_ptr<const LightCorrection>& correction);
  // Returns true if there is a correction.
  bool Corrected() const { return correction_ != nullptr; }

  // Returns the height of the ground's lowest point above sea level.
  double Lowest_m() const { return lowest_m_; }
  GroundVariant Variant() const { return {.relief = relief_}; }
  // Returns true if ground may stand between the eye and a storm. Level ground has its highest
  // point below the storm, at the height Lowest_m, so it hides nothing from an eye above that
  // height.
  bool MayHide(const scene::View& view) const {
    return relief_ || (view.ground_curvature_per_m > 0.0 && view.eye_m.z < lowest_m_);
  }

  // Draws the distance of the ground along each pixel's ray. Rays through media end at this
  // distance. If `chosen` is not null, it draws the distances along the chosen rays instead, and
  // `size` must be ChosenRays::Size().
  absl::Status DrawDistance(const scene::View& view, const glm::ivec2& size,
                            const ChosenRays* chosen = nullptr);
  const gl::Texture2D& Distance() const { return distances_[drawn_distance_].distance_m; }

  // Sets the uniforms and textures of common/ground.glsl for coordinates relative to the eye.
  void Bind(const gl::Program& program, const scene::View& view) const;
  // Sets the uniforms and textures of common/storm_shadow.glsl.
  void BindShadow(const gl::Program& program, const scene::View& view) const;
  // Sets the uniforms and textures of the correction, if there is one.
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
  const gl::Texture2D* shared_shadow_ = nullptr;  // if not null, used in place of shadow_
  gl::Texture2D shadow_;
  gl::Framebuffer shadow_target_;
  glm::dvec3 shadow_middle_m_{0.0};
  // Axes of the shadow map. The dot product of an axis and an offset from shadow_middle_m_ is 1 at
  // half the shadow's width (right, up) or depth (down, away from the sun).
  glm::dvec3 shadow_right_{0.0};
  glm::dvec3 shadow_up_{0.0};
  glm::dvec3 shadow_down_{0.0};

  std::shared_ptr<const LightCorrection> correction_;
  gl::Texture2D skylight_factor_;

  struct Distances {
    gl::Texture2D distance_m;
    gl::Framebuffer target;
  };
  std::array<Distances, 2> distances_;  // the second entry is for ChosenRays
  std::size_t drawn_distance_ = 0;      // index in distances_ of the entry that was drawn last
};

}  // namespace thunderhead::renderers
