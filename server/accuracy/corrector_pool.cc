#include "accuracy/corrector_pool.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/status.h"

namespace thunderhead::accuracy {

CorrectorPool::Kept* CorrectorPool::Serving(
    const scene::Scene& scene, const std::shared_ptr<const volume::HydrometeorFields>& fields) {
  if (scene::TracedLightOf(scene.rendering.technique) == scene::TracedLight::kOff) return nullptr;
  const auto found = std::find_if(kept_.begin(), kept_.end(), [&](const Kept& kept) {
    return kept.corrector->Serves(scene, fields);
  });
  return found == kept_.end() ? nullptr : &*found;
}

LightCorrector* CorrectorPool::Find(
    const scene::Scene& scene, const std::shared_ptr<const volume::HydrometeorFields>& fields) {
  Kept* const kept = Serving(scene, fields);
  if (kept != nullptr) kept->since_used.Restart();
  LightCorrector* const corrector = kept == nullptr ? nullptr : kept->corrector.get();
  DropUnused();
  return corrector;
}

void CorrectorPool::DropUnused() {
  std::erase_if(kept_, [this](const Kept& kept) {
    return !kept.IsClaimed() && kept.since_used.ElapsedMs() > 1e3 * unused_s_;
  });
}

absl::Status CorrectorPool::MakeRoom() {
  if (kept_.size() < max_correctors_) return absl::OkStatus();
  const auto idle_ms = [](const Kept& kept) {
    return kept.IsClaimed() ? -1.0 : kept.since_traced.ElapsedMs();
  };
  const auto oldest =
      std::max_element(kept_.begin(), kept_.end(),
                       [&](const Kept& a, const Kept& b) { return idle_ms(a) < idle_ms(b); });
  if (idle_ms(*oldest) < 1e3 * busy_s_) {
    return absl::ResourceExhaustedError(
        absl::StrCat("the server traces the light of ", kept_.size(), " other scenes already"));
  }
  kept_.erase(oldest);
  return absl::OkStatus();
}

absl::StatusOr<LightProgress> CorrectorPool::Trace(
    const scene::Scene& scene, const std::shared_ptr<const volume::HydrometeorFields>& fields,
    LightClaim* claim) {
  if (!TracesLight(scene, *fields)) return LightProgress{};
  Kept* kept = Serving(scene, fields);
  if (kept == nullptr) {
    THUNDERHEAD_RETURN_IF_ERROR(MakeRoom());
    THUNDERHEAD_ASSIGN_OR_RETURN(std::unique_ptr<LightCorrector> corrector,
                                 LightCorrector::Create(scene, fields, programs_, 0));
    kept = &kept_.emplace_back(Kept{std::move(corrector), base::Stopwatch(), base::Stopwatch()});
  }
  if (claim != nullptr) *claim = kept->claim;
  kept->corrector->LookAs(scene);
  THUNDERHEAD_RETURN_IF_ERROR(kept->corrector->Step());
  kept->since_traced.Restart();
  kept->since_used.Restart();
  const LightProgress progress = kept->corrector->Progress();
  DropUnused();
  return progress;
}

}  // namespace thunderhead::accuracy
