// Moves sessions when the times of their storm change. A session that shows the last time advances
// to a newer last time. Other sessions keep their time, even if its index changes.
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

// A time of a storm, as a scene refers to it: by the storm's id and the time's index.
struct StormPlace {
  std::string storm_id;
  std::uint32_t time_index = 0;

  bool operator==(const StormPlace&) const = default;
};

// Returns the time that a scene should show after `change`, if it showed `time_index` before. The
// last time becomes the new last time. Another time stays the same time; if it no longer exists,
// the preceding time is returned, or the first time if none precedes it. If the storm had
// disappeared and is back, the index stays the same, up to the last index. Returns nothing if the
// storm is gone.
std::optional<StormPlace> PlaceAfter(const storm_store::StormChange& change,
                                     std::uint32_t time_index);

class CatalogueFollower {
 public:
  // Subscribes to the store's changes for as long as this object exists. All arguments must outlive
  // this object.
  CatalogueFollower(storm_store::StormStore& store, session::Sessions& sessions,
                    const drawing::RenderLoop& loop);
  // Waits for a change that is being processed.
  ~CatalogueFollower();
  CatalogueFollower(const CatalogueFollower&) = delete;
  CatalogueFollower& operator=(const CatalogueFollower&) = delete;

  // Returns the number of changes of the catalogue so far. Clients are notified of each change.
  std::uint64_t Changes() const { return changes_; }

  // Returns the current id of a storm that formerly had the id `id`. (A run with one file is named
  // after the file, and after its folder once it has more files.) Returns `id` itself if no
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
