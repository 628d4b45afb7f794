// Man's two-pass renderer of metaballs on the device (P. Man, Generating and Real-Time Rendering of
// Clouds, section 4). The first pass computes the light that arrives at every ball from each of
// several coloured lights. These are the sun, the sky with the ground, and the scene's own lights.
// The second pass splats the balls in their order from the eye. The result is the balls' radiance
// towards the eye (rgb) and their transmittance (a).
//
// Transport kPaper follows the paper as printed. Transport kConsistent uses the fields' own optics
// and loses no energy.
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
  // The renderer gets its linked shader programs from `programs`.
  explicit MetaballRenderer(std::shared_ptr<gl::ProgramCache> programs)
      : programs_(std::move(programs)) {}

  // Performs the first pass. `content` gives the optics of the groups to which the balls' shares
  // refer, and must have at least one group. Returns INVALID_ARGUMENT if a ball has a radius that
  // is not above 0, an extinction below 0, or a number that is not finite. The message names the
  // ball. The arrived light of a light source is kept while its direction, the balls and their
  // optics stay the same.
  absl::Status CarryLight(const BallCloud& cloud, const Medium& content,
                          const RenderSettings& settings);

  // Performs the second pass with the balls and the light of the last CarryLight. The share of
  // `detail` sets the roughness of the balls' surfaces. The wavelength of the roughness follows
  // from the balls' size. If `noises` is null, or with paper transport, the surfaces are smooth.
  absl::Status DrawView(const RenderSettings& settings, const scene::Detail& detail = {},
                        DetailNoises* noises = nullptr);

  // Returns the result of the last DrawView.
  const gl::Texture2D& Eye() const { return eye_; }
  const gl::Texture2D& Distances_m() const { return distances_m_; }
  // Returns the box around the balls of the last CarryLight.
  const BallBox& Box() const { return box_; }
  // Returns for how many lights the last CarryLight computed the arrived light. For the other
  // lights it kept the result of an earlier call.
  int CarriedLights() const { return carried_lights_; }
  std::size_t Bytes() const;

 private:
  // A light from one direction or, if `diffuse` is true, the light of the sky above and the ground
  // below.
  struct Light {
    glm::dvec3 towards{0.0, 0.0, 1.0};
    glm::vec3 irradiance{0.0F};
    bool diffuse = false;

    bool ArrivesAs(const Light& other) const {
      return towards == other.towards && diffuse == other.diffuse;
    }
  };

  // The inputs, apart from a light's direction, that determine how much of the light arrives at
  // each ball.
  struct Optics {
    std::vector<glm::vec4> balls;  // all values of the balls, as in the device's buffer
    bool paper = false;
    double paper_albedo = 0.0;
    bool translucent = false;

    bool operator==(const Optics&) const = default;
  };

  static std::vector<Light> LightsOf(const RenderSettings& settings);
  void Upload(const BallCloud& cloud, const Medium& content, const RenderSettings& settings);
  // Allocates memory for the arrived light of `lights`. Copies the results of lights that the last
  // call also had. Returns the indices of the other lights.
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
  std::vector<Light> lights_;  // the lights whose results are in `arrived_`
  Optics optics_;              // optics of the last CarryLight
  int carried_lights_ = 0;
  Medium content_;
  int groups_ = 1;
  bool colored_ = false;
  gl::Buffer ball_buffer_;
  gl::Buffer arrived_;  // the light that arrives at each ball, light by light
  gl::Buffer sources_;  // the light that each ball sends to the eye
  gl::Buffer order_;    // order of the balls in the current pass
  gl::Buffer tile_starts_;
  gl::Texture2D light_;
  PhaseCurves phase_curves_;
  std::shared_ptr<const DetailNoise> noise_;  // set when first needed
  gl::Texture2D eye_;
  gl::Texture2D distances_m_;
  gl::Framebuffer eye_target_;
};

}  // namespace thunderhead::renderers
