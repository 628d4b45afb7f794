#include "reference/trace_scene.h"

#include "base/status.h"
#include "reference/scene_problem.h"

namespace thunderhead::reference {

absl::StatusOr<TracedScene> TraceScene(const scene::Scene& scene,
                                       const volume::HydrometeorFields& fields,
                                       const RefineLimits& limits, const ImageObserver& observer,
                                       const std::stop_token& stop) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const auto medium, MediumOf(scene, fields, Sides::kOpen));
  PathTracer tracer(medium, SurroundingsOf(scene, fields, GroundLight::kUniform),
                    CameraOf(scene, fields), {scene.output.width_px, scene.output.height_px}, {});
  TracedScene traced;
  traced.result = tracer.Refine(limits, observer, stop);
  traced.image = tracer.Snapshot();
  return traced;
}

}  // namespace thunderhead::reference
