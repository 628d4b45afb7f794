// Corrects a scene's light volume by the reference, step by step: draws small pictures of the
// storm, half of them from near where the scene's camera stands and half from all around, traces
// one path along each of their rays, and fits what the drawn radiance is to be multiplied by. Paths
// from the ground correct its skylight. The result is the same for any number of threads. Owns GL
// objects: use it on the context's thread.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <stop_token>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "correction/correction_fit.h"
#include "correction/light_progress.h"
#include "glm/vec2.hpp"
#include "glm/vec3.hpp"
#include "reference/medium.h"
#include "reference/surroundings.h"
#include "renderers/light_correction.h"
#include "renderers/scene_renderer.h"
#include "scene/scene.h"
#include "volume/hydrometeor_fields.h"
#include "volume/visible_box.h"

namespace thunderhead::correction {

// True if the scene asks for traced light, and there is something of which it can be traced.
bool TracesLight(const scene::Scene& scene, const volume::HydrometeorFields& fields);

class LightCorrector {
 public:
  // The scene traces light. Programs are linked in `programs`; `threads` trace, 0 takes all
  // cores.
  static absl::StatusOr<std::unique_ptr<LightCorrector>> Create(
      const scene::Scene& scene, std::shared_ptr<const volume::HydrometeorFields> fields,
      std::shared_ptr<gl::ProgramCache> programs, int threads);

  // True if the correction is one for this scene too: at most its camera and its display differ.
  bool Serves(const scene::Scene& scene,
              const std::shared_ptr<const volume::HydrometeorFields>& fields) const;

  // Another scene that it serves: half of the pictures look from its camera from now on.
  void LookAs(const scene::Scene& scene);

  // Goes on by some thousand paths: over the ground alone at first, then one picture each time.
  absl::Status Step();
  // Steps until that is reached (LightProgress::HasTraced); CANCELLED if `stop` asked to stop
  // before. `observer`, which may be null, is told the share of the paths that there are.
  absl::Status TraceUntil(std::int64_t paths, const std::stop_token& stop,
                          const std::function<void(double)>& observer);

  // Paths in all, the ground's not counted.
  const LightProgress& Progress() const { return progress_; }

  // What the paths so far say; null before the first.
  std::shared_ptr<const renderers::LightCorrection> Correction();

 private:
  // What is drawn from one camera, four values a pixel, rows from bottom to top.
  struct Probe {
    std::vector<float> whole;
    std::vector<float> behind;  // the storm lets as much pass, but sends no light
    std::vector<float> places;  // DrawQuality::places
  };

  LightCorrector(const scene::Scene& scene, std::shared_ptr<const volume::HydrometeorFields> fields,
                 std::shared_ptr<const reference::Medium> medium,
                 std::shared_ptr<gl::ProgramCache> programs, int threads);

  scene::Camera NextCamera() const;
  absl::StatusOr<Probe> DrawProbe();
  void TraceProbe(const Probe& probe);
  void TraceGround();
  std::shared_ptr<renderers::LightCorrection> WithGround() const;
  void UpdateGround();

  scene::Scene scene_;  // as it is probed
  scene::Scene asked_;
  std::shared_ptr<const volume::HydrometeorFields> fields_;
  std::shared_ptr<const reference::Medium> medium_;
  volume::WorldBox box_;
  reference::Surroundings over_ground_;  // as rays from the ground meet them: no air before them
  int threads_;
  renderers::SceneRenderer renderer_;
  CorrectionFit storm_fit_;
  CorrectionFit ground_fit_;
  glm::dvec3 sky_sum_{0.0};  // radiance of the clear sky over the ground's rays
  // The ground as it is known, with the storm as it is drawn and without light.
  std::shared_ptr<const renderers::LightCorrection> plain_;
  std::shared_ptr<const renderers::LightCorrection> black_;
  std::shared_ptr<const renderers::LightCorrection> correction_;  // null after a step
  std::uint64_t ground_passes_ = 0;
  std::uint64_t pictures_ = 0;
  LightProgress progress_;
};

}  // namespace thunderhead::correction
