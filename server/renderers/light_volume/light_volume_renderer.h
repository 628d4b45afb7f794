// A renderer that computes light once for many views. Sunlight is propagated along the sun's rays
// and stored at the medium's cells. This is done once for a sun, fields and their parameters. After
// a camera move, only view rays march through the medium and the stored light. They skip empty
// bricks and end where the rest of the ray is no longer visible. The result is the medium's
// radiance towards the eye (rgb) and its transmittance (a).
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
  // The renderer gets its linked shader programs from `programs`.
  explicit LightVolumeRenderer(std::shared_ptr<gl::ProgramCache> programs)
      : programs_(std::move(programs)), light_medium_(programs_), diffusion_(programs_) {}

  // A callback that computes the ground's light. CarryLight calls it after it has computed Shadow.
  using GroundFinder = std::function<absl::StatusOr<LitGround>()>;

  // Propagates the light to the cells. `medium` must not be empty. Diffusion transport gets the
  // light of the ground from `ground`. If `ground` is null, or with other transports, the ground
  // counts as open.
  absl::Status CarryLight(const ResidentMedium& medium, const RenderSettings& settings,
                          const GroundFinder& ground = nullptr);

  // Returns the shadow of the medium of the last CarryLight, in the format of
  // common/storm_shadow.glsl. The texture covers LightFrameOf the medium's box.
  const gl::Texture2D& Shadow() const { return shadow_; }

  // Return the light of the last CarryLight, for checks. Carried is the light along the sun's rays
  // from carry.comp, with the layer nearest to the sun first. Arrived is the light at the medium's
  // cells from arrive.comp.
  const gl::Texture3D& Carried() const { return carried_; }
  const gl::Texture3D& Arrived() const { return arrived_; }
  // Returns the diffusion pass, which only diffusion transport uses.
  const DiffusionPass& Diffusion() const { return diffusion_; }

  // Draws `medium` with the light of the last CarryLight, which must have had the same medium, sun
  // and technique.
  absl::Status DrawView(const ResidentMedium& medium, const RenderSettings& settings);

  // Returns the result of the last DrawView.
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
  // Runs arrive.comp in the blocks of cells with an index from `first` to `end` - 1. `near` is
  // ArriveVariant::near.
  absl::Status ArriveIn(const ResidentMedium& medium, const GroupWeights& weights,
                        const LightBox& box, const CarryVariant& variant, int near, int first,
                        int end);

  void BindDiffusion(const gl::Program& program, const ResidentMedium& medium,
                     const GroupWeights& weights, const RenderSettings& settings);

  // Binds the correction's textures. Uploads them unless they are already on the device.
  void BindCorrection(const std::shared_ptr<const LightCorrection>& correction);

  std::shared_ptr<gl::ProgramCache> programs_;
  gl::WholeTarget whole_target_;
  std::array<CoveredTarget, 2> eyes_;  // the second target is for ChosenRays
  std::size_t drawn_ = 0;              // index of the target that the last DrawView used
  LightMedium light_medium_;
  gl::Texture3D carried_;  // light along the sun's rays
  gl::Texture2D thickness_;
  gl::Texture2D shadow_;
  gl::Texture3D arrived_;  // light at the medium's cells
  // Ratio of two optical depths of the path next to each cell (arrive.comp). It was computed for
  // version `near_version_` of light_medium_. The texture is empty on devices that compute whole
  // targets (gl/whole_target.h).
  gl::Texture3D near_ratio_;
  std::uint64_t near_version_ = 0;
  SunParts near_parts_;
  GLenum light_format_ = 0;
  DiffusionPass diffusion_;
  std::shared_ptr<const LightCorrection> correction_;  // the correction that is in the textures
  std::array<gl::Texture3D, 3> correction_textures_;   // one for each colour
};

}  // namespace thunderhead::renderers
