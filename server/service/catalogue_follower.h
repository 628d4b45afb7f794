// Moves sessions when the times of their storm change. A session that shows the newest time
// advances to a newer one. Other sessions keep their time, even if its index changes.
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "drawing/render_loop.h"
#include "session/sessions.h"
#include "storm_store/storm_store.h"

namespace thunderhead::service {

// A time of a storm, as a scene refers to it.
struct StormPlace {
  std::string storm_id;
  std::uint32_t time_index = 0;

  bool operator==(const StormPlace&) const = default;
};

// Returns the time that a scene should show after a change, given the time that it showed before.
// The last time stays the last. Other times stay the same, or become the preceding one if the time
// no longer exists. If the storm returns after an absence, the index stays or becomes the last.
// Returns nothing if the storm is gone.
std::optional<StormPlace> PlaceAfter(const storm_store::StormChange& change,
                                     std::uint32_t time_index);

class CatalogueFollower {
 public:
  // Listens to the store during its lifetime. All arguments must outlive it.
  CatalogueFollower(storm_store::StormStore& store, session::Sessions& sessions,
                    const drawing::RenderLoop& loop);
  // Waits for a change that is being processed.
  ~CatalogueFollower();
  CatalogueFollower(const CatalogueFollower&) = delete;
  CatalogueFollower& operator=(const CatalogueFollower&) = delete;

  // Returns the number of changes of the catalogue so far. Clients are notified of each.
  std::uint64_t Changes() const { return changes_; }

  // Returns the current id of a storm that formerly had `id`. A run with one file is named after
  // the file; with two or more files it is named after its folder. Returns `id` itself if no
  // renaming is known.
  std::string IdNow(std::string id) const;

 private:
  void Follow(const storm_store::CatalogueChange& change);
  bool Move(session::Session& session, const storm_store::CatalogueChange& change);

  storm_store::StormStore& store_;
  session::Sessions& sessions_;
  const drawing::RenderLoop& loop_;
  std::atomic<std::uint64_t> changes_{0};
  mutable std::mutex mutex_;
  std::map<std::string, std::string> renamed_;
};

}  // namespace thunderhead::service
