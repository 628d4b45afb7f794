#include "accuracy/corrector_pool.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/status.h"
#include "reference/scene_problem.h"

namespace thunderhead::accuracy {
namespace {

// A correction is fitted and published again when its number of paths has grown by the factor
// kPublishedGrowth, or after kMaxUnpublished_ms. It is not fitted after every step, because a fit
// takes as long as several steps of tracing.
constexpr double kPublishedGrowth = 1.2;
constexpr double kMaxUnpublished_ms = 2000.0;

}  // namespace

CorrectorPool::Kept* CorrectorPool::Serving(
    const scene::Scene& scene, const std::shared_ptr<const volume::HydrometeorFields>& fields) {
  if (scene::TracedLightOf(scene.rendering.technique) == scene::TracedLight::kOff) return nullptr;
  const auto found = std::find_if(kept_.begin(), kept_.end(), [&](const Kept& kept) {
    return kept.corrector->Serves(scene, fields);
  });
  return found == kept_.end() ? nullptr : &*found;
}

const LightCorrector* CorrectorPool::Find(
    const scene::Scene& scene, const std::shared_ptr<const volume::HydrometeorFields>& fields) {
  const Kept* const kept = Serving(scene, fields);
  return kept == nullptr ? nullptr : kept->corrector.get();
}

void CorrectorPool::DropUnused() {
  std::erase_if(kept_, [this](const Kept& kept) {
    const double unused_ms = std::min(kept.since_traced.ElapsedMs(), kept.published->UnusedMs());
    return !kept.IsClaimed() && unused_ms > 1e3 * unused_s_;
  });
}

// Returns the least recently used idle corrector, or end() if all correctors are busy or claimed.
std::list<CorrectorPool::Kept>::iterator CorrectorPool::OldestIdle() {
  const auto idle_ms = [](const Kept& kept) {
    return kept.IsClaimed() ? -1.0 : kept.since_traced.ElapsedMs();
  };
  const auto oldest =
      std::max_element(kept_.begin(), kept_.end(),
                       [&](const Kept& a, const Kept& b) { return idle_ms(a) < idle_ms(b); });
  if (oldest == kept_.end() || idle_ms(*oldest) < 1e3 * busy_s_) return kept_.end();
  return oldest;
}

bool CorrectorPool::DropOldest() {
  const auto oldest = OldestIdle();
  if (oldest == kept_.end()) return false;
  kept_.erase(oldest);
  return true;
}

absl::Status CorrectorPool::MakeRoom() {
  if (kept_.size() < max_correctors_ || DropOldest()) return absl::OkStatus();
  return absl::ResourceExhaustedError(absl::StrCat("the server traces the light of ", kept_.size(),
                                                   " other scenes already; try again later"));
}

absl::StatusOr<base::MemoryReservation> CorrectorPool::Reserve(std::size_t bytes) {
  while (true) {
    auto reserved = memory_->Reserve(base::MemoryUse::kTracing, bytes, "tracing a storm's light",
                                     base::MemoryBudget::Urgency::kAhead);
    if (reserved.ok() || base::IsTooLargeForMemory(reserved.status())) return reserved;
    if (!DropOldest()) return reserved;
  }
}

void CorrectorPool::Publish(Kept& kept, std::int64_t wanted_paths) {
  const LightProgress& progress = kept.corrector->Progress();
  if (!progress.Corrects() || progress.paths == kept.published_paths) return;
  const bool more = static_cast<double>(progress.paths) >=
                    kPublishedGrowth * static_cast<double>(kept.published_paths);
  const bool late = kept.since_published.ElapsedMs() > kMaxUnpublished_ms;
  if (!more && !late && !progress.HasTraced(wanted_paths)) return;
  kept.published->Publish({kept.corrector->Correction(), progress.paths});
  kept.published_paths = progress.paths;
  kept.since_published.Restart();
}

absl::StatusOr<LightProgress> CorrectorPool::Trace(
    const scene::Scene& scene, const std::shared_ptr<const volume::HydrometeorFields>& fields,
    LightClaim* claim, std::int64_t wanted_paths) {
  if (!TracesLight(scene, *fields)) return LightProgress{};
  Kept* kept = Serving(scene, fields);
  if (kept == nullptr) {
    THUNDERHEAD_RETURN_IF_ERROR(MakeRoom());
    THUNDERHEAD_ASSIGN_OR_RETURN(base::MemoryReservation reserved,
                                 Reserve(reference::MediumBytes(*fields, true)));
    THUNDERHEAD_ASSIGN_OR_RETURN(std::unique_ptr<LightCorrector> corrector,
                                 LightCorrector::Create(scene, fields, programs_, 0));
    kept = &kept_.emplace_back();
    kept->reserved = std::move(reserved);
    kept->corrector = std::move(corrector);
    kept->published = std::make_unique<TracedLights::Entry>(lights_, scene, fields);
  }
  if (claim != nullptr) *claim = kept->claim;
  kept->since_traced.Restart();  // counts as busy from now on
  kept->corrector->LookAs(scene);
  THUNDERHEAD_RETURN_IF_ERROR(kept->corrector->Step());
  kept->since_traced.Restart();
  Publish(*kept, wanted_paths);
  const LightProgress progress = kept->corrector->Progress();
  DropUnused();
  return progress;
}

}  // namespace thunderhead::accuracy
