// Half-angle slicing. An eye buffer and a light buffer advance together through slices of the
// medium, one slab of slices at a time. Sunlight is propagated through the slab, with a layer for
// each slice. One pass then adds the slab to the picture (docs/decisions/0013-slabs.md). The result
// is the medium's radiance towards the eye (rgb) and its transmittance (a), before sky and ground.
//
// The method is that of Riley et al. 2003 (Vis), section 4.4. Transport `kPaper` is eq. 14-17 as
// printed. Transport `kConsistent` replaces the stepwise arithmetic by the exact exponential of the
// effective extinction. It adds delta scaling and a diffusion term (Eddington) for light scattered
// many times.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "absl/status/status.h"
#include "gl/objects.h"
#include "gl/program.h"
#include "gl/whole_target.h"
#include "renderers/group_weights.h"
#include "renderers/half_angle/buffer_ring.h"
#include "renderers/half_angle/slice_reach.h"
#include "renderers/half_angle/slicing.h"
#include "renderers/medium.h"
#include "renderers/render_settings.h"

namespace thunderhead::renderers {

class HalfAngleRenderer {
 public:
  // The renderer gets its linked shader programs from `programs`.
  explicit HalfAngleRenderer(std::shared_ptr<gl::ProgramCache> programs);

  // Draws `medium`, which must not be empty. `light_changed` must be true if the medium or the sun
  // differs from the last call.
  absl::Status Render(const ResidentMedium& medium, const RenderSettings& settings,
                      bool light_changed);

  // Returns the result of the last Render.
  const gl::Texture2D& Eye() const { return eye_[last_eye_].Texture(); }
  const gl::Texture2D& Distances_m() const { return eye_[last_eye_].Distances(); }
  // Returns the light that leaves the last slice, before neighbouring texels exchange light for the
  // last time. It has four floats for each texel of the light buffer. The first float is the share
  // of sunlight.
  std::vector<float> Light() const { return light_.Download(static_cast<int>(last_layer_)); }
  std::size_t Bytes() const;

 private:
  struct Programs;
  struct Slab;
  struct CarriedLight;

  void Resize(const LightFrame& frame, double cell_m);
  absl::Status SumThickness(const ResidentMedium& medium, const LightFrame& frame,
                            const GroupWeights& weights);
  absl::Status DrawSlabs(const Programs& programs, const RenderSettings& settings,
                         std::size_t at_once, const std::vector<SliceReach>& reach);
  void CarryThrough(const Slab& slab, const gl::Program& program, std::size_t at_once,
                    const std::vector<SliceReach>& reach, CarriedLight* light);
  absl::Status DrawSlab(const Slab& slab, const gl::Program& eye, const Cover* cover,
                        const PixelRect& rect, const gl::Framebuffer& target);

  std::shared_ptr<gl::ProgramCache> programs_;
  gl::WholeTarget whole_target_;
  std::array<CoveredTarget, 2> eye_;  // the picture before and after a slab, alternately
  std::size_t last_eye_ = 0;
  gl::Texture2DArray light_;    // the light that enters each slice, by layer
  std::size_t last_layer_ = 0;  // layer behind the last slice
  PixelRect light_reach_;       // rectangle of texels outside which sunlight is unshaded
  gl::Texture2D ring_depth_;    // optical depth scattered to neighbours since the last exchange
  gl::Texture2D thickness_;
};

}  // namespace thunderhead::renderers
