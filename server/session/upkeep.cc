#include "session/upkeep.h"

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "glm/geometric.hpp"
#include "scene/place_seen.h"

namespace thunderhead::session {
namespace {

// Maximum pause of the thread. Expiring sessions do not wake it, so it must wake at least this
// often.
constexpr std::chrono::seconds kLongestPause{1};
// Interval between two checks of which times are in memory. The store's own threads load and evict
// times and do not wake this thread.
constexpr std::chrono::seconds kHeldTimesPause{1};
// Minimum pause of the thread, so that sessions that are due at about the same time are handled
// together.
constexpr std::chrono::milliseconds kShortestPause{10};

void TellOfMemory(Session& session, const storm_store::StormStore& store, Clock::time_point now) {
  const std::optional<NewestScene> newest = session.Newest();
  if (!newest.has_value()) return;
  const std::string& storm_id = newest->scene->storm_id;
  session.audience().Hold({storm_id, store.TimesInMemory(storm_id)}, now);
}

}  // namespace

Upkeep::Upkeep(Sessions& sessions, storm_store::StormStore& store, base::WakeSignal& due)
    : sessions_(sessions), store_(store), due_(due), thread_([this] { Run(); }) {}

Upkeep::~Upkeep() {
  stopping_ = true;
  due_.Notify();
  thread_.join();
}

void Upkeep::Run() {
  const base::TimeSource& time = sessions_.time();
  Clock::time_point looked_into_memory{};
  while (!stopping_) {
    const Clock::time_point began = time.Now();
    // The minimum pause limits the CPU load, so it uses the real clock.
    const Clock::time_point pauses_until = Clock::now() + kShortestPause;
    const bool looks_into_memory = began >= looked_into_memory + kHeldTimesPause;
    if (looks_into_memory) looked_into_memory = began;
    Clock::time_point next = began + kLongestPause;
    const auto wait_for = [&](const std::optional<Clock::time_point>& due) {
      if (due.has_value()) next = std::min(next, *due);
    };
    for (const auto& session : sessions_.AllDrawn()) {
      const Clock::time_point now = time.Now();
      if (looks_into_memory) TellOfMemory(*session, store_, now);
      wait_for(session->audience().Tick(
          now, [&](const Ray& ray) { return PlaceSeen(*session, store_, ray); }));
      wait_for(session->hub().WakeWaiting(now));
    }
    std::this_thread::sleep_until(pauses_until);
    if (next > time.Now()) due_.Wait(next, time);
  }
}

glm::dvec3 PlaceSeen(const Session& session, storm_store::StormStore& store, const Ray& ray) {
  const std::optional<NewestScene> newest = session.Newest();
  const auto fields =
      newest.has_value() ? store.Peek(newest->scene->storm_id, newest->scene->time_index) : nullptr;
  if (fields != nullptr) {
    return scene::PlaceSeen(*newest->scene, *fields, ray.origin_m, ray.direction);
  }
  // Returns the point of the ray that is nearest to the middle of the domain, which is the origin
  // of world coordinates.
  return ray.origin_m + std::max(0.0, -glm::dot(ray.origin_m, ray.direction)) * ray.direction;
}

std::vector<glm::dvec3> LineSeen(const Session& session, storm_store::StormStore& store,
                                 const std::vector<Ray>& rays) {
  std::vector<double> distances_m;
  distances_m.reserve(rays.size());
  for (const Ray& ray : rays) {
    distances_m.push_back(glm::distance(ray.origin_m, PlaceSeen(session, store, ray)));
  }
  const auto middle = distances_m.begin() + static_cast<std::ptrdiff_t>(distances_m.size() / 2);
  std::ranges::nth_element(distances_m, middle);
  std::vector<glm::dvec3> positions_m;
  positions_m.reserve(rays.size());
  for (const Ray& ray : rays) positions_m.push_back(ray.origin_m + *middle * ray.direction);
  return positions_m;
}

}  // namespace thunderhead::session
