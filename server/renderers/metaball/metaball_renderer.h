// Man's two-pass renderer of metaballs (P. Man, Generating and Real-Time Rendering of Clouds,
// section 4), on the device: the first pass gives every ball its light from each of several
// coloured lights (the sun, the sky and the ground, the scene's own), the second splats the balls
// in their order from the eye. The result is their radiance towards the eye (rgb) and their
// transmittance (a).
//
// Transport "paper" is as printed; "consistent" has the fields' own optics and loses no energy.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "gl/objects.h"
#include "gl/program.h"
#include "gl/whole_target.h"
#include "renderers/group_weights.h"
#include "renderers/medium.h"
#include "renderers/metaball/ball_cloud.h"
#include "renderers/phase_curves.h"
#include "renderers/render_settings.h"

namespace thunderhead::renderers {

class MetaballRenderer {
 public:
  // Programs are linked in `programs`.
  explicit MetaballRenderer(std::shared_ptr<gl::ProgramCache> programs)
      : programs_(std::move(programs)) {}

  // The first pass. `content` tells how the groups scatter that the balls' shares are of; it must
  // have a group. INVALID_ARGUMENT names a ball that is none: a radius that is not above 0, an
  // extinction below 0, or a number that is not finite. What arrived of a light is kept while its
  // direction, the balls and their optics stay.
  absl::Status CarryLight(const BallCloud& cloud, const Medium& content,
                          const RenderSettings& settings);

  // The second pass, with the balls and the light of the last CarryLight.
  // The balls' surfaces are as rough as the share of `detail` says; their wavelength follows from
  // the balls' size. Without `noises`, and with paper transport, they are smooth.
  absl::Status DrawView(const RenderSettings& settings, const scene::Detail& detail = {},
                        DetailNoises* noises = nullptr);

  // The result of the last DrawView.
  const gl::Texture2D& Eye() const { return eye_; }
  const gl::Texture2D& Distances_m() const { return distances_m_; }
  // Around the balls of the last CarryLight.
  const BallBox& Box() const { return box_; }
  // How many lights the last CarryLight carried; what arrived of the others was kept.
  int CarriedLights() const { return carried_lights_; }
  std::size_t Bytes() const;

 private:
  // A light that comes from one direction, or with `diffuse` the sky above and the ground below.
  struct Light {
    glm::dvec3 towards{0.0, 0.0, 1.0};
    glm::vec3 irradiance{0.0F};
    bool diffuse = false;

    bool ArrivesAs(const Light& other) const {
      return towards == other.towards && diffuse == other.diffuse;
    }
  };

  // Everything but its direction that the transmittance of a light through the balls depends on.
  struct Optics {
    std::vector<glm::vec4> balls;  // as the device has them
    bool paper = false;
    double paper_albedo = 0.0;
    bool translucent = false;

    bool operator==(const Optics&) const = default;
  };

  static std::vector<Light> LightsOf(const RenderSettings& settings);
  void Upload(const BallCloud& cloud, const Medium& content, const RenderSettings& settings);
  // Makes room for what arrives of `lights`, with what is known of those that were carried.
  // Returns the others.
  std::vector<int> KeepArrived(const std::vector<Light>& lights);
  absl::Status Carry(const Light& light, int index, const RenderSettings& settings);
  absl::Status FindSources(const RenderSettings& settings);
  absl::Status Splat(const RenderSettings& settings, const scene::Detail& detail,
                     DetailNoises* noises);
  void BindNoise(const gl::Program& program, const RenderSettings& settings, float share) const;

  std::shared_ptr<gl::ProgramCache> programs_;
  gl::WholeTarget whole_target_;
  std::vector<Ball> balls_;
  BallBox box_;
  std::vector<Light> lights_;  // that `arrived_` holds
  Optics optics_;              // of the last CarryLight
  int carried_lights_ = 0;
  Medium content_;
  int groups_ = 1;
  bool colored_ = false;
  gl::Buffer ball_buffer_;
  gl::Buffer arrived_;  // the light of each ball, light by light
  gl::Buffer sources_;  // what each sends to the eye
  gl::Buffer order_;    // of the pass that runs
  gl::Buffer tile_starts_;
  gl::Texture2D light_;
  PhaseCurves phase_curves_;
  std::shared_ptr<const DetailNoise> noise_;  // once it was needed
  gl::Texture2D eye_;
  gl::Texture2D distances_m_;
  gl::Framebuffer eye_target_;
};

}  // namespace thunderhead::renderers
