#include "reference/trace_scene.h"

#include "base/status.h"
#include "reference/scene_problem.h"

namespace thunderhead::reference {

absl::StatusOr<TracedScene> TraceScene(const scene::Scene& scene,
                                       const volume::HydrometeorFields& fields, double peak_cut_deg,
                                       const RefineLimits& limits, const ImageObserver& observer,
                                       const std::stop_token& stop) {
  MediumOptions options;
  options.peak_cut_deg = peak_cut_deg;
  THUNDERHEAD_ASSIGN_OR_RETURN(const auto medium, MediumOf(scene, fields, options));
  PathTracer tracer(medium, SurroundingsOf(scene, fields, GroundLight::kShaded),
                    CameraOf(scene, fields), {scene.output.width_px, scene.output.height_px}, {});
  TracedScene traced;
  traced.result = tracer.Refine(limits, observer, stop);
  traced.image = tracer.Snapshot();
  return traced;
}

}  // namespace thunderhead::reference
