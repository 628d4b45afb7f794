// A thread that does periodic work for the people of all sessions. It computes the positions of
// pointers, ends requests for control and absences that have timed out, sends due updates, and
// reports which times are in memory. It also wakes viewers with a limited frame rate.
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
  // SessionSignals::on_due of `sessions` must notify `due`. All three arguments must outlive this
  // object.
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

// Returns the point where the ray hits what the session shows: the storm or the ground. In the
// clear sky, or while the storm is not in memory, returns a point near the storm's middle.
glm::dvec3 PlaceSeen(const Session& session, storm_store::StormStore& store, const Ray& ray);
// Returns a line along the rays, of which there must be at least one. All its points lie at the
// median distance at which the rays hit something, so that the line keeps its shape when the camera
// turns.
std::vector<glm::dvec3> LineSeen(const Session& session, storm_store::StormStore& store,
                                 const std::vector<Ray>& rays);

}  // namespace thunderhead::session
