// Neyret's phenomenological shading of cumulus clouds (2000, "A Phenomenological Shader for the
// Rendering of Cumulus Clouds") in real time. The first pass ray-casts the ellipsoids and finds the
// distance of the nearest opaque core. The second pass shades each fragment near that core or in
// front of it, as in section 4 of the paper. The result is radiance (rgb) and transmittance (a),
// like that of the renderers that draw a medium. The class owns GL objects, so use it on the
// context's thread.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "clouds/cumulus_surface.h"
#include "gl/objects.h"
#include "gl/program.h"
#include "gl/whole_target.h"
#include "physics/turbulence.h"
#include "renderers/detail_noises.h"
#include "renderers/light_frame.h"
#include "renderers/render_settings.h"

namespace thunderhead::renderers {

class CumulusRenderer {
 public:
  // The renderer gets its linked shader programs from `programs`.
  explicit CumulusRenderer(std::shared_ptr<gl::ProgramCache> programs)
      : programs_(std::move(programs)) {}

  // Sets the surface, which may be empty.
  void SetSurface(const clouds::CumulusSurface& surface);
  bool Empty() const { return count_ == 0; }
  int BubbleCount() const { return count_; }
  glm::dvec3 Middle_m() const { return (box_.low_m + box_.high_m) / 2.0; }
  glm::dvec3 HalfExtent_m() const { return (box_.high_m - box_.low_m) / 2.0; }

  // Draws a shadow map: the surface's depth as seen from the sun. The surface must not be empty.
  absl::Status CastShadow(const RenderSettings& settings);
  // Returns the share of sunlight that the surface blocks from reaching the ground. The texture
  // covers ShadowFrame around the middle of the surface. Call CastShadow first.
  absl::StatusOr<gl::Texture2D> GroundShadow();
  const LightFrame& ShadowFrame() const { return shadow_frame_; }

  // Draws the surface with the shadow map of the last CastShadow. `light_map` comes from
  // LightMapOf.
  absl::Status DrawView(const RenderSettings& settings, const std::vector<glm::vec3>& light_map,
                        DetailNoises* noises);

  const gl::Texture2D& Eye() const { return eye_; }
  const gl::Texture2D& Distances_m() const { return distances_m_; }
  std::size_t Bytes() const;

 private:
  struct Pass;

  void Resize(const glm::ivec2& size);
  void SetShading(const gl::Program& program, const RenderSettings& settings,
                  const std::vector<glm::vec3>& light_map, DetailNoises* noises);
  absl::Status DrawDepth(const Pass& pass, const gl::Framebuffer& target);
  // `far_m` is the distance that depth 1 stands for. `middle_m` is the distance of the surface's
  // middle.
  absl::Status Resolve(double far_m, double middle_m);
  absl::Status DrawBubbles(const gl::Program& program, const Pass& pass,
                           const gl::PieceCost& bubble) const;
  double Corona_m(const scene::Cumulus& cumulus) const;

  std::shared_ptr<gl::ProgramCache> programs_;
  gl::VertexArray no_attributes_ = gl::VertexArray::Empty();
  gl::WholeTarget whole_target_;

  std::vector<glm::vec3> centres_m_;  // centres relative to the middle of the surface's box
  std::vector<float> radii_m_;
  int count_ = 0;
  double finest_m_ = 1.0;
  clouds::SurfaceBox box_;
  bool has_base_ = false;
  float base_m_ = 0.0F;  // height of the base relative to the middle
  gl::Buffer bubbles_;

  LightFrame shadow_frame_;
  double shadow_reach_m_ = 1.0;
  gl::Texture2D shadow_depth_;
  gl::Framebuffer shadow_target_;

  gl::Texture2D core_depth_;
  gl::Framebuffer core_target_;
  gl::Texture2D tested_depth_;  // copy of core_depth_ for the depth test
  gl::Texture2D cores_;
  gl::Texture2D layer_;
  gl::Framebuffer shade_target_;
  gl::Texture2D eye_;
  gl::Texture2D distances_m_;
  gl::Framebuffer eye_target_;
  std::shared_ptr<const DetailNoise> noise_;
};

}  // namespace thunderhead::renderers
