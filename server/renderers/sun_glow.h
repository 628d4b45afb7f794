// The sun as a viewer sees it: its disc and, through a medium, the aureole. The aureole is light
// scattered within the forward peaks of the phase functions. The techniques cut these peaks off and
// count their light as unscattered (physics/aureole.h). Disc and aureole are added to the linear
// frame around the sun. If the sun is out of view, they cost no time. The class owns GL objects, so
// use it on the context's thread.
#pragma once

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "gl/objects.h"
#include "gl/program.h"
#include "gl/whole_target.h"
#include "glm/vec2.hpp"
#include "physics/hydrometeors.h"
#include "renderers/cover.h"
#include "renderers/ground.h"
#include "renderers/medium.h"
#include "scene/scene.h"
#include "scene/view.h"

namespace thunderhead::renderers {

// Returns the pixels of a picture of `size_px` whose rays may be within `angle_rad` of `direction`.
// The rectangle is empty if no ray is.
PixelRect RectAround(const glm::dvec3& direction, double angle_rad, const scene::View& view,
                     const glm::ivec2& size_px);

class SunGlow {
 public:
  explicit SunGlow(std::shared_ptr<gl::ProgramCache> programs) : programs_(std::move(programs)) {}

  struct Sun {
    glm::dvec3 towards{0.0, 0.0, 1.0};
    glm::vec3 irradiance{0.0F};  // irradiance at the eye
  };
  struct Picture {
    const gl::Framebuffer& target;  // the linear frame
    glm::ivec2 size_px{1};
    // If not null, the frame consists of these rays instead of the picture's pixels.
    const ChosenRays* chosen = nullptr;
  };

  // Adds the disc and the aureole seen through `medium`, which may be empty. The medium is drawn
  // with `settings` and `slices` samples along a ray. The function redraws the distances in
  // `ground`.
  absl::Status AddThrough(const ResidentMedium& medium, const scene::MediumSettings& settings,
                          int slices, const Sun& sun, const scene::View& view, Ground* ground,
                          const Picture& picture);

  // Adds only the disc, behind the content of `eye` (Technique::Eye).
  absl::Status AddBehind(const gl::Texture2D& eye, const Sun& sun, const scene::View& view,
                         const Ground& ground, const Picture& picture);

  std::size_t Bytes() const { return table_.Bytes(); }

 private:
  // Computes the aureoles of the medium's groups, unless they are already known.
  void Tabulate(const Medium& medium, double cut_rad);
  absl::Status Add(const gl::Program& program, const gl::PieceCost& pixel, const PixelRect& rect,
                   const Picture& picture);
  void BindSun(const gl::Program& program, const Sun& sun, const scene::View& view,
               const Picture& picture) const;

  std::shared_ptr<gl::ProgramCache> programs_;
  gl::WholeTarget whole_target_;
  // Phase functions of the tabulated aureoles, by group.
  std::vector<physics::PhaseFunction> tabulated_;
  double tabulated_cut_rad_ = -1.0;
  gl::Texture3D table_;
  // For each group, the share of its scattering that lies in the cut peak.
  std::vector<float> shares_;
};

}  // namespace thunderhead::renderers
