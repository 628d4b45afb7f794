#include "reference/trace_scene.h"

#include <utility>

#include "base/status.h"
#include "reference/scene_problem.h"

namespace thunderhead::reference {
namespace {

void TakeAwayAir(const scene::Scene& scene, Surroundings* surroundings) {
  surroundings->sun_irradiance = glm::dvec3(scene.sun.irradiance);
  surroundings->sun_by_height.clear();
  surroundings->sky = nullptr;
  surroundings->seen_sky = nullptr;
  surroundings->air = nullptr;
  surroundings->shaded_air.reset();
  surroundings->disc.reset();
}

}  // namespace

absl::StatusOr<TracedScene> TraceScene(const scene::Scene& scene,
                                       const volume::HydrometeorFields& fields,
                                       const TraceOptions& options, const RefineLimits& limits,
                                       const ImageObserver& observer, const std::stop_token& stop) {
  MediumOptions of_medium;
  of_medium.peak_cut_deg = options.peak_cut_deg;
  of_medium.detail_voxels_per_cell = options.detail_voxels_per_cell;
  THUNDERHEAD_ASSIGN_OR_RETURN(const auto medium, MediumOf(scene, fields, of_medium));
  Surroundings surroundings = SurroundingsOf(scene, fields, GroundLight::kShaded);
  if (!options.air) TakeAwayAir(scene, &surroundings);
  if (!options.sun) {
    surroundings.sun_irradiance = glm::dvec3(0.0);
    surroundings.sun_by_height.clear();
    surroundings.disc.reset();
  }
  PathTracerOptions of_paths;
  of_paths.max_scatterings = options.max_scatterings;
  PathTracer tracer(medium, std::move(surroundings), CameraOf(scene, fields),
                    {scene.output.width_px, scene.output.height_px}, of_paths);
  TracedScene traced;
  traced.result = tracer.Refine(limits, observer, stop);
  traced.image = tracer.Snapshot();
  return traced;
}

absl::StatusOr<TracedScene> TraceScene(const scene::Scene& scene,
                                       const volume::HydrometeorFields& fields, double peak_cut_deg,
                                       const RefineLimits& limits, const ImageObserver& observer,
                                       const std::stop_token& stop) {
  TraceOptions options;
  options.peak_cut_deg = peak_cut_deg;
  return TraceScene(scene, fields, options, limits, observer, stop);
}

}  // namespace thunderhead::reference
