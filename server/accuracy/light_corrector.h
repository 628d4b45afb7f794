// Corrects a scene's light volume progressively with the reference. It draws small pictures of the
// storm, half of them from near the scene's camera and half from all directions. It traces one or
// two paths along each of their rays and fits factors for the drawn radiance. Paths from the ground
// correct the ground's skylight. The result does not depend on the number of threads. Owns GL
// objects: use it on the context's thread, which draws in pieces (gl/pieces.h).
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

// Returns true if the scene requests traced light, its renderer can show it, and a field is drawn.
bool TracesLight(const scene::Scene& scene, const volume::HydrometeorFields& fields);

class LightCorrector {
 public:
  // Creates a corrector; TracesLight must be true. Links programs in `programs`. Traces on the
  // device if device_paths::TracesOnDevice(), else on `threads` threads (0: all cores).
  static absl::StatusOr<std::unique_ptr<LightCorrector>> Create(
      const scene::Scene& scene, std::shared_ptr<const volume::HydrometeorFields> fields,
      std::shared_ptr<gl::ProgramCache> programs, int threads);

  // Returns true if the correction is valid for this scene: only its camera, display and similar
  // settings may differ.
  bool Serves(const scene::Scene& scene,
              const std::shared_ptr<const volume::HydrometeorFields>& fields) const;

  // Continues with the camera of `scene`, for which Serves must be true. From then on half of the
  // pictures are drawn from near that camera.
  void LookAs(const scene::Scene& scene);

  // Traces some thousand paths. The first steps trace only the ground; each later step traces one
  // picture. Fails if it cannot draw, or if the work is no longer needed (gl::Pieces::Wanted).
  absl::Status Step();
  // Steps until LightProgress::HasTraced(paths). CANCELLED if `stop` is requested earlier.
  // `observer` may be null; otherwise it receives the share of paths traced.
  absl::Status TraceUntil(std::int64_t paths, const std::stop_token& stop,
                          const std::function<void(double)>& observer);

  // Returns the total number of paths, without those of the ground.
  const LightProgress& Progress() const { return progress_; }

  // Returns the correction from all paths so far. Null while there are too few paths
  // (LightProgress::Corrects).
  std::shared_ptr<const renderers::LightCorrection> Correction();

 private:
  // Pictures drawn from one camera, with four values per pixel and rows from bottom to top. They
  // are empty if no storm is visible.
  struct Probe {
    std::vector<float> whole;
    std::vector<float> behind;  // background dimmed by the storm, without its radiance
    // As in renderers::SeenStorm.
    std::vector<float> storm;
    std::vector<float> opacity_distance_m;  // the first of four values
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
  // The current correction of the ground, which does not change the storm.
  std::shared_ptr<const renderers::LightCorrection> plain_;
  std::shared_ptr<const renderers::LightCorrection> correction_;  // null: must be computed again
  std::uint64_t ground_passes_ = 0;
  std::uint64_t pictures_ = 0;
  LightProgress progress_;
};

}  // namespace thunderhead::accuracy
