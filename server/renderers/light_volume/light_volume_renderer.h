// Light once, view many: sunlight is carried along the sun's rays and given to the medium's cells,
// once for a sun, fields and their parameters; a camera move only marches view rays through the
// medium and that light, leaping over empty bricks and ending where nothing more shows. The result
// is the medium's radiance towards the eye (rgb) and its transmittance (a).
//
// The light model is that of half-angle slicing (Riley et al. 2003, Vis, 4.4), without the exchange
// of light between neighbouring rays.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <utility>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "gl/objects.h"
#include "gl/program.h"
#include "gl/whole_target.h"
#include "renderers/group_weights.h"
#include "renderers/light_frame.h"
#include "renderers/light_volume/diffusion_pass.h"
#include "renderers/light_volume/light_medium.h"
#include "renderers/light_volume/sun_parts.h"
#include "renderers/light_volume/variants.h"
#include "renderers/lit_ground.h"
#include "renderers/medium.h"
#include "renderers/render_settings.h"

namespace thunderhead::renderers {

class LightVolumeRenderer {
 public:
  // Programs are linked in `programs`.
  explicit LightVolumeRenderer(std::shared_ptr<gl::ProgramCache> programs)
      : programs_(std::move(programs)), light_medium_(programs_), diffusion_(programs_) {}

  // Finds the ground's light once Shadow is known.
  using GroundFinder = std::function<absl::StatusOr<LitGround>()>;

  // Carries the light to the cells. `medium` must not be empty. Diffusion transport takes the light
  // of the ground from `ground`; without it, as other transports do, for that of open ground.
  absl::Status CarryLight(const ResidentMedium& medium, const RenderSettings& settings,
                          const GroundFinder& ground = nullptr);

  // The shadow of the last CarryLight's medium, as common/storm_shadow.glsl has it, over
  // LightFrameOf its box.
  const gl::Texture2D& Shadow() const { return shadow_; }

  // The light of the last CarryLight, for checks: along the sun's rays, from the sun on, and at the
  // medium's cells, as carry.comp and arrive.comp write them.
  const gl::Texture3D& Carried() const { return carried_; }
  const gl::Texture3D& Arrived() const { return arrived_; }
  // Of diffusion transport alone.
  const DiffusionPass& Diffusion() const { return diffusion_; }

  // Draws `medium` with the light of the last CarryLight, which must have had the same medium, sun
  // and rendering.
  absl::Status DrawView(const ResidentMedium& medium, const RenderSettings& settings);

  // The result of the last DrawView.
  const gl::Texture2D& Eye() const { return eyes_[drawn_].Texture(); }
  const gl::Texture2D& Distances_m() const { return eyes_[drawn_].Distances(); }
  std::size_t Bytes() const;

 private:
  struct LightBox;

  void Resize(const glm::ivec3& carried, const glm::ivec3& cells, GLenum format);
  absl::Status Carry(const ResidentMedium& medium, const GroupWeights& weights, const LightBox& box,
                     const CarryVariant& variant);
  absl::Status Arrive(const ResidentMedium& medium, const GroupWeights& weights,
                      const LightBox& box, const CarryVariant& variant, bool in_turns);
  // In the blocks of cells from `first` to before `end`; `near` as ArriveVariant has it.
  absl::Status ArriveIn(const ResidentMedium& medium, const GroupWeights& weights,
                        const LightBox& box, const CarryVariant& variant, int near, int first,
                        int end);

  void BindDiffusion(const gl::Program& program, const ResidentMedium& medium,
                     const GroupWeights& weights, const RenderSettings& settings);

  // Puts it on the device unless it is there.
  void BindCorrection(const std::shared_ptr<const LightCorrection>& correction);

  std::shared_ptr<gl::ProgramCache> programs_;
  gl::WholeTarget whole_target_;
  std::array<CoveredTarget, 2> eyes_;  // the second is for chosen rays
  std::size_t drawn_ = 0;              // by the last DrawView
  LightMedium light_medium_;
  gl::Texture3D carried_;  // along the sun's rays
  gl::Texture2D thickness_;
  gl::Texture2D shadow_;
  gl::Texture3D arrived_;  // at the medium's cells
  // Of the depth next to cells (arrive.comp), for light_medium_'s version `near_version_`; empty on
  // devices that do not draw sparsely.
  gl::Texture3D near_ratio_;
  std::uint64_t near_version_ = 0;
  SunParts near_parts_;
  GLenum light_format_ = 0;
  DiffusionPass diffusion_;
  std::shared_ptr<const LightCorrection> correction_;  // that the textures hold
  std::array<gl::Texture3D, 3> correction_textures_;   // by colour
};

}  // namespace thunderhead::renderers
