// Corrects a scene's light volume progressively by path tracing. It draws small pictures of the
// storm (probes), half of them from near the scene's camera and half from all directions. For each
// pixel of a probe, it traces one or two paths with the reference technique. From them it fits
// correction factors for the drawn radiance (accuracy/correction_fit.h). Paths from the ground
// correct the skylight on the ground. The result does not depend on the number of threads. The
// class owns GL objects, so it must be used on the context's thread, which draws in pieces
// (gl/pieces.h).
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

// Returns true if the scene requests the path-traced correction, its technique supports it, and at
// least one field is drawn.
bool TracesLight(const scene::Scene& scene, const volume::HydrometeorFields& fields);

class LightCorrector {
 public:
  // Creates a corrector. TracesLight must be true for the scene. `programs` caches linked shader
  // programs. Paths are traced on the device if device_paths::TracesOnDevice(), and otherwise on
  // `threads` CPU threads; 0 means one for each core.
  static absl::StatusOr<std::unique_ptr<LightCorrector>> Create(
      const scene::Scene& scene, std::shared_ptr<const volume::HydrometeorFields> fields,
      std::shared_ptr<gl::ProgramCache> programs, int threads);

  // Returns true if the correction is valid for this scene: only its camera, display and similar
  // settings may differ.
  bool Serves(const scene::Scene& scene,
              const std::shared_ptr<const volume::HydrometeorFields>& fields) const;

  // Uses the camera of `scene` from now on. Half of the following probes are drawn from near this
  // camera. Serves must be true for `scene`.
  void LookAs(const scene::Scene& scene);

  // Traces some thousand paths. The first steps trace only paths from the ground; each later step
  // traces one probe. Returns an error if the probe cannot be drawn, or if the work is no longer
  // needed (gl::Pieces::Wanted).
  absl::Status Step();
  // Calls Step until LightProgress::HasTraced(paths). Returns CANCELLED if `stop` is requested
  // earlier. `observer` receives the part of the paths that are traced, 0 to 1. It may be empty.
  absl::Status TraceUntil(std::int64_t paths, const std::stop_token& stop,
                          const std::function<void(double)>& observer);

  // Returns the progress. Its number of paths does not include the paths from the ground.
  const LightProgress& Progress() const { return progress_; }

  // Returns the correction that was fitted to all paths so far, or null while there are too few
  // paths (LightProgress::Corrects).
  std::shared_ptr<const renderers::LightCorrection> Correction();

 private:
  // The pictures of one probe, all drawn from one camera. They have four values per pixel and rows
  // from bottom to top. They are empty if no storm is visible.
  struct Probe {
    std::vector<float> whole;
    std::vector<float> behind;  // the background, dimmed by the storm but without the storm's
                                // radiance
    // The textures of renderers::SeenStorm.
    std::vector<float> storm;
    std::vector<float> opacity_distance_m;  // only the first of the four values is used
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

  scene::Scene scene_;  // the scene that the probes draw (ProbedScene)
  scene::Scene asked_;
  std::shared_ptr<const volume::HydrometeorFields> fields_;
  reference::RayTracer tracer_;
  volume::WorldBox box_;
  std::shared_ptr<const reference::SceneLight> light_;
  reference::Surroundings over_ground_;  // the surroundings for rays from the ground, which have no
                                         // air in front of the storm
  int threads_;
  std::shared_ptr<gl::ProgramCache> programs_;
  renderers::SceneRenderer renderer_;
  CorrectionFit storm_fit_;
  CorrectionFit ground_fit_;
  glm::dvec3 sky_sum_{0.0};  // sum of the clear sky's radiance over the ground's rays
  // A correction that contains only the current correction of the ground.
  std::shared_ptr<const renderers::LightCorrection> plain_;
  std::shared_ptr<const renderers::LightCorrection> correction_;  // null if it must be computed
                                                                  // again
  std::uint64_t ground_passes_ = 0;
  std::uint64_t pictures_ = 0;
  LightProgress progress_;
};

}  // namespace thunderhead::accuracy
