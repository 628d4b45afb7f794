#include "service/engine/catalogue_follower.h"

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>

#include "service/engine/engine.h"
#include "service/engine/scene_update.h"
#include "service/messages/prepare_scene.h"
#include "spdlog/spdlog.h"

namespace thunderhead::service {
namespace {

// If another change of a session's scene is in progress, moving the session is tried this many
// times. After that, the other change (which may wait for a long read) is assumed to be based on
// the new catalogue.
constexpr int kAttempts = 40;
constexpr std::chrono::milliseconds kBetweenAttempts{50};

// Returns true if the file of the time at that index was replaced or rewritten, or if the storm has
// come back.
bool IsReplaced(const storm_store::StormChange& change, std::size_t time) {
  if (change.before == nullptr) return true;
  const std::vector<storm_store::StormTime>& before = change.before->times;
  return time < before.size() && before[time].version != change.after->times[time].version;
}

}  // namespace

std::optional<StormPlace> PlaceAfter(const storm_store::StormChange& change,
                                     std::uint32_t time_index) {
  if (change.after == nullptr) return std::nullopt;
  const std::vector<storm_store::StormTime>& after = change.after->times;
  if (change.before == nullptr) {
    const auto last = static_cast<std::uint32_t>(after.size() - 1);
    return StormPlace{change.after->id, std::min(time_index, last)};
  }
  const std::vector<storm_store::StormTime>& before = change.before->times;
  const auto place = [&](std::size_t index) {
    return StormPlace{change.after->id, static_cast<std::uint32_t>(index)};
  };
  if (time_index + 1 >= before.size()) return place(after.size() - 1);
  // ISO 8601 strings sort in the order of their times, so they are compared as texts.
  const auto at = std::ranges::upper_bound(after, before[time_index].valid_time, {},
                                           &storm_store::StormTime::valid_time);
  return place(at == after.begin() ? 0 : static_cast<std::size_t>(at - after.begin()) - 1);
}

CatalogueFollower::CatalogueFollower(storm_store::StormStore& store, session::Sessions& sessions,
                                     const drawing::RenderLoop& loop)
    : store_(store), sessions_(sessions), loop_(loop) {
  store_.Listen([this](const storm_store::CatalogueChange& change) { Follow(change); });
}

CatalogueFollower::~CatalogueFollower() { store_.Listen({}); }

std::string CatalogueFollower::IdNow(std::string id) const {
  if (store_.Find(id) != nullptr) return id;
  const std::lock_guard lock(mutex_);
  // Each renaming is followed at most once, so that a cycle of names ends.
  for (std::size_t i = 0; i <= renamed_.size(); ++i) {
    const auto next = renamed_.find(id);
    if (next == renamed_.end()) return id;
    id = next->second;
  }
  return id;
}

void CatalogueFollower::Follow(const storm_store::CatalogueChange& change) {
  {
    const std::lock_guard lock(mutex_);
    for (const storm_store::StormChange& storm : change) {
      if (storm.before == nullptr || storm.after == nullptr) continue;
      if (storm.before->id != storm.after->id) renamed_[storm.before->id] = storm.after->id;
    }
  }
  std::vector<std::shared_ptr<session::Session>> sessions = sessions_.All();
  const std::vector<std::shared_ptr<session::Session>> everybody = sessions;
  for (int attempt = 0; attempt < kAttempts && !sessions.empty(); ++attempt) {
    if (attempt > 0) std::this_thread::sleep_for(kBetweenAttempts);
    std::erase_if(sessions, [&](const auto& session) { return Move(*session, change); });
  }
  // The sessions are moved before clients are notified, so that a client that then asks for the
  // times finds its scene's time.
  ++changes_;
  for (const auto& session : everybody) session->audience().WakeAll();
}

// Returns false if the move must be retried.
bool CatalogueFollower::Move(session::Session& session,
                             const storm_store::CatalogueChange& change) {
  if (!session.Newest().has_value()) return true;
  absl::StatusOr<ReadScene> newest = NewestSceneOf(session);
  if (!newest.ok()) return true;
  v1::Scene& scene = newest->scene;
  // A storm that was absent comes back under its id. Sessions that could not show it meanwhile are
  // then moved too.
  const auto at = std::ranges::find_if(change, [&](const storm_store::StormChange& storm) {
    return (storm.before != nullptr ? storm.before : storm.after)->id == scene.storm_id();
  });
  if (at == change.end()) return true;
  const std::optional<StormPlace> place = PlaceAfter(*at, scene.time_index());
  if (!place.has_value()) return true;
  const bool moves = *place != StormPlace{scene.storm_id(), scene.time_index()};
  if (!moves && !IsReplaced(*at, scene.time_index())) return true;
  scene.set_storm_id(place->storm_id);
  scene.set_time_index(place->time_index);
  if (const absl::Status ready = PrepareScene(store_, loop_.Techniques(), scene); !ready.ok()) {
    spdlog::warn("a session cannot show the change of storm {}: {}", place->storm_id,
                 std::string(ready.message()));
    return true;
  }
  const absl::StatusOr<std::uint64_t> revision = session.TakeRevisionAfter(newest->revision);
  if (!revision.ok()) return false;
  ShowScene(store_, session, *revision, scene);
  return true;
}

}  // namespace thunderhead::service
