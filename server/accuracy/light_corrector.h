// Corrects a scene's light volume progressively by the reference: draws small pictures of the
// storm, half of them from near the scene's camera and half from all around, traces one or two
// paths along each of their rays, and fits factors for the drawn radiance. Paths from the ground
// correct its skylight. The result is the same for any number of threads. Owns GL objects: use it
// on the context's thread, which draws in pieces (gl/pieces.h).
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <stop_token>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "accuracy/correction_fit.h"
#include "accuracy/light_progress.h"
#include "glm/vec2.hpp"
#include "glm/vec3.hpp"
#include "reference/brick_walk.h"
#include "reference/scene_problem.h"
#include "reference/surroundings.h"
#include "reference/trace_rays.h"
#include "renderers/light_correction.h"
#include "renderers/scene_renderer.h"
#include "scene/scene.h"
#include "volume/hydrometeor_fields.h"
#include "volume/visible_box.h"

namespace thunderhead::accuracy {

// True if the scene asks for traced light, its renderer can show it, and a field is drawn.
bool TracesLight(const scene::Scene& scene, const volume::HydrometeorFields& fields);

class LightCorrector {
 public:
  // TracesLight must be true. Links programs in `programs`. Traces on the device if
  // device_paths::TracesOnDevice(), else on `threads` threads (0: all cores).
  static absl::StatusOr<std::unique_ptr<LightCorrector>> Create(
      const scene::Scene& scene, std::shared_ptr<const volume::HydrometeorFields> fields,
      std::shared_ptr<gl::ProgramCache> programs, int threads);

  // True if the correction is valid for this scene: only its camera, display and the like may
  // differ.
  bool Serves(const scene::Scene& scene,
              const std::shared_ptr<const volume::HydrometeorFields>& fields) const;

  // Continues with the camera of `scene`, for which Serves must be true: half of the pictures are
  // taken from near it from now on.
  void LookAs(const scene::Scene& scene);

  // Traces some thousand paths: of the ground alone in the first steps, then one picture a step.
  // Fails if it cannot draw, or nobody wants it any more (gl::Pieces::Wanted).
  absl::Status Step();
  // Steps until LightProgress::HasTraced(paths); CANCELLED if `stop` asks to stop before.
  // `observer`, which may be null, gets the share of paths traced.
  absl::Status TraceUntil(std::int64_t paths, const std::stop_token& stop,
                          const std::function<void(double)>& observer);

  // Total number of paths, without the ground's.
  const LightProgress& Progress() const { return progress_; }

  // The correction from all paths so far; null while these are too few to be worth it
  // (LightProgress::Corrects).
  std::shared_ptr<const renderers::LightCorrection> Correction();

 private:
  // Pictures drawn from one camera: four values a pixel, rows from bottom to top; empty where there
  // is no storm to be seen.
  struct Probe {
    std::vector<float> whole;
    std::vector<float> behind;  // with the storm's transmittance, but black
    // As renderers::SeenStorm has it.
    std::vector<float> storm;
    std::vector<float> opacity_distance_m;  // the first of four
    volume::WorldBox box;
  };

  LightCorrector(const scene::Scene& scene, std::shared_ptr<const volume::HydrometeorFields> fields,
                 reference::RayTracer tracer, std::shared_ptr<gl::ProgramCache> programs,
                 int threads);

  scene::Camera NextCamera() const;
  absl::StatusOr<Probe> DrawProbe();
  absl::Status TraceProbe(const Probe& probe);
  absl::Status TraceGround();
  absl::StatusOr<std::vector<glm::dvec3>> Traced(const reference::Surroundings& surroundings,
                                                 const std::vector<reference::Ray>& rays,
                                                 std::uint64_t seed, int paths_of_ray) const;
  std::shared_ptr<renderers::LightCorrection> WithGround() const;
  void UpdateGround();

  scene::Scene scene_;  // as the probes draw it
  scene::Scene asked_;
  std::shared_ptr<const volume::HydrometeorFields> fields_;
  reference::RayTracer tracer_;
  volume::WorldBox box_;
  std::shared_ptr<const reference::SceneLight> light_;
  reference::Surroundings over_ground_;  // as seen by rays from the ground: without air in front
  int threads_;
  std::shared_ptr<gl::ProgramCache> programs_;
  renderers::SceneRenderer renderer_;
  CorrectionFit storm_fit_;
  CorrectionFit ground_fit_;
  glm::dvec3 sky_sum_{0.0};  // sum of the clear sky's radiance over the ground's rays
  // The correction of the ground so far, which leaves the storm as it is.
  std::shared_ptr<const renderers::LightCorrection> plain_;
  std::shared_ptr<const renderers::LightCorrection> correction_;  // null: must be computed again
  std::uint64_t ground_passes_ = 0;
  std::uint64_t pictures_ = 0;
  LightProgress progress_;
};

}  // namespace thunderhead::accuracy
