// Half-angle slicing: an eye buffer and a light buffer advance together through slices of the
// medium. The result is what the medium sends to the eye (rgb) and the share of the background that
// passes (a), before sky and ground.
//
// Riley et al. 2003 (Vis), section 4.4; transport `kPaper` is eq. 14-17 as printed, `kConsistent`
// the same idea with the exact exponential of the effective extinction, delta scaling, and a
// diffusion term (Eddington) for light scattered many times.
#pragma once

#include <memory>

#include "absl/status/status.h"
#include "gl/objects.h"
#include "gl/program.h"
#include "renderers/group_weights.h"
#include "renderers/half_angle/slice_reach.h"
#include "renderers/half_angle/slicing.h"
#include "renderers/medium.h"
#include "renderers/render_settings.h"

namespace thunderhead::renderers {

class HalfAngleRenderer {
 public:
  // Programs are linked in `programs`.
  explicit HalfAngleRenderer(std::shared_ptr<gl::ProgramCache> programs);

  // Draws `medium`, which must not be empty. `light_changed` says that the medium or the sun differ
  // from the last call.
  absl::Status Render(const ResidentMedium& medium, const RenderSettings& settings,
                      bool light_changed);

  // The result of the last Render.
  const gl::Texture2D& Eye() const { return eye_.Texture(); }
  // The light buffer after the last slice: r is the share of sunlight that comes through the
  // medium.
  const gl::Texture2D& Light() const { return light_[last_light_]; }
  std::size_t Bytes() const;

 private:
  struct Programs;

  void Resize(const LightFrame& frame, double cell_m);
  absl::Status DrawThickness(const ResidentMedium& medium, const RenderSettings& settings,
                             const LightFrame& frame, const GroupWeights& weights);
  void DrawSlices(const Programs& programs, const RenderSettings& settings, const Slicing& slicing,
                  const std::vector<SliceReach>& reach);

  std::shared_ptr<gl::ProgramCache> programs_;
  gl::VertexArray no_attributes_ = gl::VertexArray::Empty();
  CoveredTarget eye_;
  gl::Texture2D light_[2];
  int last_light_ = 0;
  gl::Framebuffer light_target_[2];
  gl::Texture2D thickness_;
  gl::Framebuffer thickness_target_;
};

}  // namespace thunderhead::renderers
