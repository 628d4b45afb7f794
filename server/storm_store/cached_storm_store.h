// The implementation of the store that StormStore::Open returns. It has a catalogue, a cache,
// threads that read requested times, and a thread that reads ahead. If several callers request the
// same time, it is read once. Reads with a waiting caller have priority over read-ahead, and over
// the catalogue's examination of files.
//
// Reads run one after another, in order to limit the memory that they need. Only if a read takes
// long does a read of another file begin in parallel. A storage that hangs can block some of the
// reading threads, but never the last one. A caller waits for a hanging read no longer than
// StormStoreOptions::read_deadline.
#pragma once

#include <array>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/loose_thread.h"
#include "storm_files/vertical_remap.h"
#include "storm_store/fields_cache.h"
#include "storm_store/live_catalogue.h"
#include "storm_store/storm_catalogue.h"
#include "storm_store/storm_ids.h"
#include "storm_store/storm_store.h"

namespace thunderhead::storm_store {

class CachedStormStore final : public StormStore,
                               public std::enable_shared_from_this<CachedStormStore>,
                               private base::MemoryBudget::Cache {
 public:
  // Creates a store that reads nothing until it is passed to Owned.
  CachedStormStore(const std::vector<CataloguedStorm>& storms, const StormStoreOptions& options);

  // Returns an owner of the store. The store's threads run until the owner is destroyed. A thread
  // that hangs keeps the store in memory.
  static std::unique_ptr<StormStore> Owned(std::shared_ptr<CachedStormStore> store);

  CachedStormStore(const CachedStormStore&) = delete;
  CachedStormStore& operator=(const CachedStormStore&) = delete;

  std::vector<StormInfoPtr> Storms() const override;
  absl::StatusOr<StormInfoPtr> Add(const std::string& path) override;
  absl::Status Remove(std::string_view id) override;
  absl::StatusOr<std::shared_ptr<const volume::HydrometeorFields>> Get(
      std::string_view id, int time_index, const ReadProgress& progress) override;
  std::shared_ptr<const volume::HydrometeorFields> Peek(std::string_view id,
                                                        int time_index) override;
  std::vector<int> TimesInMemory(std::string_view id) const override;
  std::size_t CachedBytes() const override;
  void Listen(CatalogueListener listener) override;
  std::size_t PendingReads() const override;
  std::optional<HungRead> Hung() const override;

  // Replaces the storms under the searched paths by `found`, and reports the changes to the
  // listener. Storms that were added by Add stay. A time whose file is gone stays while its fields
  // are in use.
  void Renew(const std::vector<CataloguedStorm>& found);

  // Waits, up to a time limit, until no caller is waiting for a read. The catalogue calls it before
  // it examines a file.
  void LetReadersGoFirst();

  // Starts to keep the store's storms up to date with the results of `scan`.
  void Follow(std::unique_ptr<CatalogueScan> scan);
  // Waits for the end of the first search, but at most for LiveCatalogueOptions::first_search.
  // Returns whether the search has ended.
  bool AwaitFirstSearch();
  bool IsSearching() const override;

 private:
  class Handle;
  using Fields = absl::StatusOr<std::shared_ptr<const volume::HydrometeorFields>>;
  enum class Purpose { kAsked, kAhead };

  // The progress function of a waiting caller. It is removed when the caller stops waiting.
  struct Listener {
    std::mutex mutex;  // held while `progress` is called; no other lock may be taken meanwhile
    ReadProgress progress;
  };

  // The read that a reading thread is working on.
  struct Activity {
    bool reads = false;  // false while the thread has no read, or its read pauses
    std::string file;
    std::uint64_t device = 0;  // device of the file that is read
    std::chrono::steady_clock::time_point began;
    std::chrono::steady_clock::time_point went_on;  // time of the last progress
    bool told_of_hang = false;
  };

  // The height grid of a storm, with the path and version of the file that held the storm's first
  // time when the grid was chosen.
  struct ChosenGrid {
    storm_files::VerticalGrid grid;
    std::string path;
    std::uint64_t version = 0;
  };

  // A storm and the store's data about it.
  struct Held {
    std::shared_ptr<const CataloguedStorm> storm;  // null if the storm was removed
    std::vector<int> numbers;                      // TimeKey::time of each time; a number is never
                                                   // reused
    int next_number = 0;
    bool added = false;  // added by Add, so not found under the paths
    // The storm's id, and those that it had before its name changed. No other storm gets one of
    // them, so that a client that still uses it is not shown another storm.
    std::vector<std::string> ids;
    std::optional<ChosenGrid> grid;  // height grid for all times of the storm

    StormInfoPtr Info() const { return {storm, &storm->info}; }
  };

  // A time and the storm description that contains it. The description stays valid even if the
  // store replaces it meanwhile.
  struct Place {
    TimeKey key;
    std::shared_ptr<const CataloguedStorm> storm;
    std::size_t time = 0;  // index into the storm's times
  };

  // A read that is queued or in progress, shared by all callers that wait for it.
  struct PendingRead {
    Place place;
    Purpose purpose = Purpose::kAsked;
    Activity* activity = nullptr;  // activity of the thread that reads it; null before the read
                                   // begins
    int waiters = 0;               // number of waiting callers
    std::vector<std::shared_ptr<Listener>> listeners;
    std::optional<Fields> result;
  };

  // The functions below are called with mutex_ locked, and return with it locked. TakeFound,
  // KeepIds, Checkpoint, ReadDue, ReadAhead, Start, End and the overrides lock it themselves.
  // ReplacedRetryAfter does not need it.
  using Lock = std::unique_lock<std::mutex>;
  std::optional<std::size_t> PlaceOf(std::string_view id) const;
  absl::Status NoSuchStorm(std::string_view id) const;
  absl::StatusOr<Place> PlaceOf(std::string_view id, int time_index) const;
  std::optional<Place> PlaceOf(const TimeKey& key) const;
  std::shared_ptr<PendingRead> Begin(const Place& place, Purpose purpose);
  // Returns the pending read of `place`, or queues a new read. Returns an error if the new read
  // would have to wait for a hanging read on the same storage.
  absl::StatusOr<std::shared_ptr<PendingRead>> ReadOf(const Place& place);
  // Returns whether `read` may begin in parallel to the reads in progress.
  bool MayBegin(const PendingRead& read) const;
  // Removes the first queued read that may begin now from the queue and returns it, or null.
  std::shared_ptr<PendingRead> TakeDue();
  // Returns the time from which another read may begin in parallel to `activity`.
  std::chrono::steady_clock::time_point MayReadBesideAt(const Activity& activity) const;
  // Performs `read`. A reading thread calls it and passes its own `activity`.
  void Read(Lock& lock, PendingRead& read, Activity& activity);
  Fields ReadFile(Lock& lock, PendingRead& read, Activity& activity);
  Fields WaitFor(Lock& lock, const std::shared_ptr<PendingRead>& read,
                 const ReadProgress& progress);
  std::optional<HungRead> HungIn(const Activity& activity) const;
  // Like HungIn, but logs each hang once.
  std::optional<HungRead> NoteHang(Activity& activity) const;
  base::TimeSource::Clock::time_point Now() const { return options_.time->Now(); }
  // Returns when the activity counts as hanging unless it makes progress.
  std::chrono::steady_clock::time_point HangsAt(const Activity& activity) const;
  // Returns the hanging read that blocks `read`, if there is one. This is `read` itself or, before
  // `read` begins, another read on the same storage.
  std::optional<HungRead> HoldsUp(const PendingRead& read);
  // Returns a requested read that hangs on the storage of the file of `place`.
  std::optional<HungRead> HungOnStorageOf(const Place& place);
  absl::StatusOr<std::optional<storm_files::VerticalGrid>> VerticalGridOf(Lock& lock,
                                                                          const Place& place);
  // Sets the storm's height grid to `grid`, unless the storm already has a grid.
  void Choose(const Place& place, const storm_files::VerticalGrid& grid);
  void WantAfter(const Place& place);
  std::optional<Place> NextWanted();
  bool IsWanted(const TimeKey& key) const;
  void TakeFound(const CatalogueScan::Result& found);
  StormChange Replace(std::size_t place, std::optional<CataloguedStorm> found);
  // Returns the id for the storm at `place`, which is new or has another name. It uses `copies_`,
  // so that many storms of one name are numbered fast.
  std::string NewId(const CataloguedStorm& found, std::size_t place);
  void KeepIds();                      // passes changed ids to LiveCatalogueOptions::keep_ids
  void TakeId(std::size_t place);      // records the id of the storm at `place` as its own
  void ReleaseIds(std::size_t place);  // lets other storms take the ids of the storm at `place`

  // Returns the delay after which a file that has just replaced another one is probably described.
  std::chrono::milliseconds ReplacedRetryAfter() const;
  absl::Status Checkpoint(PendingRead& read, Activity& activity, double share);
  // Runs queued reads until the store ends. It is the function of a reading thread.
  void ReadDue(Activity& activity);
  // Waits until no other requested read is in progress, or until the store ends.
  void LetOthersEnd(Lock& lock, Activity& activity);
  void ReadAhead();

  void Start();
  void End();

  std::optional<std::chrono::steady_clock::time_point> OldestUnused() override;
  void DropOldestUnused() override;

  const StormStoreOptions options_;
  const StormIds earlier_ids_;  // ids that an earlier store gave to its storms

  mutable std::mutex mutex_;
  std::deque<Held> storms_;         // elements are never removed, so an index identifies a storm
                                    // permanently
  std::vector<std::size_t> order_;  // indices into storms_ of the listed storms, in the listed
                                    // order
  // The place of the storm that has or had an id (Held::ids).
  std::map<std::string, std::size_t, std::less<>> owners_;
  // The last number that was appended to each stem. It is valid during one Renew.
  std::map<std::string, int> copies_;
  std::condition_variable changed_;  // notified when a read ends, a time is to be read ahead, a
                                     // caller begins to wait, or the first search or the store ends
  FieldsCache cache_;
  std::map<TimeKey, std::shared_ptr<PendingRead>> pending_;
  std::deque<std::shared_ptr<PendingRead>> asked_;  // requested reads in the queue, in order
  std::array<Activity, 4> reading_asked_;           // one per thread that reads requested times
  Activity reading_ahead_;
  std::vector<TimeKey> wanted_;  // times to be read ahead, in order
  int asked_reads_ = 0;
  bool ending_ = false;
  bool searching_ = false;  // true during the first search

  std::mutex listening_;  // held while the listener is called; locked before mutex_
  CatalogueListener listener_;
  StormIds kept_ids_;       // the ids that were kept last; used by the searching thread only
  bool following_ = false;  // true if changes are reported to listener_

  // `live_` exists from Follow to End, `member_` and `threads_` from Start to End.
  std::unique_ptr<LiveCatalogue> live_;
  std::optional<base::MemoryBudget::Member> member_;
  std::vector<base::LooseThread> threads_;
};

}  // namespace thunderhead::storm_store
