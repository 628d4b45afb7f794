#include "reference/scene_tracer.h"

#include "base/status.h"
#include "reference/scene_problem.h"

namespace thunderhead::reference {

SceneTracer::SceneTracer(double peak_cut_deg, const PathTracerOptions& options)
    : peak_cut_deg_(peak_cut_deg), options_(options) {}

absl::Status SceneTracer::Begin(const scene::Scene& scene,
                                const std::shared_ptr<const volume::HydrometeorFields>& fields,
                                const glm::ivec2& size_px) {
  tracer_.reset();
  THUNDERHEAD_RETURN_IF_ERROR(Prepare(scene, fields));
  tracer_.emplace(medium_, surroundings_, camera_, size_px, options_);
  return absl::OkStatus();
}

absl::Status SceneTracer::Prepare(const scene::Scene& scene,
                                  const std::shared_ptr<const volume::HydrometeorFields>& fields) {
  const bool same_fields = prepared_scene_.has_value() && prepared_fields_.lock() == fields;
  const scene::Stage first =
      same_fields ? scene::FirstDirtyStage(*prepared_scene_, scene) : scene::Stage::kStorm;
  if (first >= scene::Stage::kTone) return absl::OkStatus();
  prepared_scene_.reset();
  if (first <= scene::Stage::kExtinction) {
    MediumOptions options;
    options.peak_cut_deg = peak_cut_deg_;
    THUNDERHEAD_ASSIGN_OR_RETURN(medium_, MediumOf(scene, *fields, options));
  }
  surroundings_ = SurroundingsOf(scene, *fields, GroundLight::kShaded);
  camera_ = CameraOf(scene, *fields);
  prepared_scene_ = scene;
  prepared_fields_ = fields;
  return absl::OkStatus();
}

RefineResult SceneTracer::Refine(const RefineLimits& limits, const std::stop_token& stop) {
  THUNDERHEAD_CHECK(tracer_.has_value(), "no picture was begun");
  return tracer_->Refine(limits, {}, stop);
}

picture::LinearPicture SceneTracer::Snapshot() const {
  THUNDERHEAD_CHECK(tracer_.has_value(), "no picture was begun");
  return tracer_->Snapshot();
}

}  // namespace thunderhead::reference
