// Keeps sessions where they are when a storm's times come and go: one that shows the newest time
// goes on to the newer one, others keep their time, wherever it stands now.
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

// A time of a storm, as a scene names it.
struct StormPlace {
  std::string storm_id;
  std::uint32_t time_index = 0;

  bool operator==(const StormPlace&) const = default;
};

// Where a scene that shows that time of the storm before a change belongs after it: at the last
// time if it was there, else at the same time, or where that is gone at the one before; in a storm
// that was gone at the same index, or the last. Nothing if the storm is gone.
std::optional<StormPlace> PlaceAfter(const storm_store::StormChange& change,
                                     std::uint32_t time_index);

class CatalogueFollower {
 public:
  // Listens to the store as long as it lives; all must outlive it.
  CatalogueFollower(storm_store::StormStore& store, session::Sessions& sessions,
                    const drawing::RenderLoop& loop);
  // Waits for a change that is being followed.
  ~CatalogueFollower();
  CatalogueFollower(const CatalogueFollower&) = delete;
  CatalogueFollower& operator=(const CatalogueFollower&) = delete;

  // How often the catalogue has changed; clients are told of each.
  std::uint64_t Changes() const { return changes_; }

  // The id that a storm has now that once had `id`: a run of one file is called by its file, and
  // from the second on by its folder. `id` itself if nothing is known of it.
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
