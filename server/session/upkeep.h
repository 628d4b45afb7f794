// Looks after the people of every session on a thread of its own: finds where their pointers point,
// ends what has run out, tells what is due and what is in memory, and wakes viewers who want few
// frames a second.
#pragma once

#include <atomic>
#include <thread>
#include <vector>

#include "base/wake_signal.h"
#include "session/sessions.h"
#include "storm_store/storm_store.h"

namespace thunderhead::session {

class Upkeep {
 public:
  // `sessions` must notify `due` in their on_due, and give the time; all must outlive it.
  Upkeep(Sessions& sessions, storm_store::StormStore& store, base::WakeSignal& due);
  ~Upkeep();
  Upkeep(const Upkeep&) = delete;
  Upkeep& operator=(const Upkeep&) = delete;

 private:
  void Run();

  Sessions& sessions_;
  storm_store::StormStore& store_;
  base::WakeSignal& due_;
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

// Where the ray meets what the session shows: storm, ground, or near the storm's middle in the
// clear sky and while the storm is not in memory.
glm::dvec3 PlaceSeen(const Session& session, storm_store::StormStore& store, const Ray& ray);
// A line along the rays, of which there must be one: at the middle of the distances to what they
// meet, so that it keeps its shape when the camera turns.
std::vector<glm::dvec3> LineSeen(const Session& session, storm_store::StormStore& store,
                                 const std::vector<Ray>& rays);

}  // namespace thunderhead::session
