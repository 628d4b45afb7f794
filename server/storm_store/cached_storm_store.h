// The implementation of the store that StormStore::Open returns. It has a catalogue, a cache,
// threads that read requested times, and a thread that reads ahead. A time is read once, however
// many callers ask for it. Reads with a waiting caller have priority over read-ahead, and over
// files that the catalogue examines.
//
// Reads run one after another, because several at once would need the memory of several. Only while
// one takes long does another read begin, of another file. A storage that hangs blocks the threads
// that read from it, but never the last one. No caller waits beyond the deadline.
#pragma once

#include <array>
#include <chrono>
#include <condition_variable>
#include <deque>
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

  // Replaces the storms of the paths by those `found`, and tells the listener what has changed.
  // Storms that were added stay. A time whose file is gone stays while its fields are in use.
  void Renew(const std::vector<CataloguedStorm>& found);

  // Waits until no caller waits for a read, up to a time limit.
  void LetReadersGoFirst();

  // Keeps the store's storms up to date from now on, with the results of `scan`.
  void Follow(std::unique_ptr<CatalogueScan> scan);
  // Waits for the first search, LiveCatalogueOptions::first_search at most. Returns whether it has
  // ended.
  bool AwaitFirstSearch();
  bool IsSearching() const override;

 private:
  class Handle;
  using Fields = absl::StatusOr<std::shared_ptr<const volume::HydrometeorFields>>;
  enum class Purpose { kAsked, kAhead };

  // A caller's listener. It is removed when the caller stops waiting.
  struct Listener {
    std::mutex mutex;  // held during a call; no lock is taken with it
    ReadProgress progress;
  };

  // A thread's read in progress.
  struct Activity {
    bool reads = false;  // false while it pauses
    std::string file;
    std::uint64_t device = 0;  // device of that file
    std::chrono::steady_clock::time_point began;
    std::chrono::steady_clock::time_point went_on;  // time of the last progress
    bool told_of_hang = false;
  };

  // The height grid of a storm, and the file of its first time when the grid was chosen.
  struct ChosenGrid {
    storm_files::VerticalGrid grid;
    std::string path;
    std::uint64_t version = 0;
  };

  // A storm, and what the store keeps for it.
  struct Held {
    std::shared_ptr<const CataloguedStorm> storm;  // null: removed
    std::vector<int> numbers;                      // one for each time, never used again
    int next_number = 0;
    bool added = false;              // added by Add, so not found under the paths
    std::optional<ChosenGrid> grid;  // the same for all times

    StormInfoPtr Info() const { return {storm, &storm->info}; }
  };

  // A time and its source. It stays valid if the storm changes meanwhile.
  struct Place {
    TimeKey key;
    std::shared_ptr<const CataloguedStorm> storm;
    std::size_t time = 0;  // index into the storm's times
  };

  // A read that is queued or in progress, shared by all callers that wait for it.
  struct PendingRead {
    Place place;
    Purpose purpose = Purpose::kAsked;
    Activity* activity = nullptr;  // activity of the reading thread, once it has begun
    int waiters = 0;               // callers that wait
    std::vector<std::shared_ptr<Listener>> listeners;
    std::optional<Fields> result;
  };

  // The functions below are called with `lock` held on mutex_ and return with it held.
  using Lock = std::unique_lock<std::mutex>;
  std::optional<std::size_t> PlaceOf(std::string_view id) const;
  absl::Status NoSuchStorm(std::string_view id) const;
  absl::StatusOr<Place> PlaceOf(std::string_view id, int time_index) const;
  std::optional<Place> PlaceOf(const TimeKey& key) const;
  std::shared_ptr<PendingRead> Begin(const Place& place, Purpose purpose);
  // Returns the pending read of that time, or a new one. Returns an error if a new read would wait
  // behind another read that hangs on the same storage.
  absl::StatusOr<std::shared_ptr<PendingRead>> ReadOf(const Place& place);
  // Returns whether that read may begin in parallel to those in progress.
  bool MayBegin(const PendingRead& read) const;
  // Takes the first read that may begin, if there is one.
  std::shared_ptr<PendingRead> TakeDue();
  // Returns when another read may begin although this one has not ended.
  std::chrono::steady_clock::time_point MayReadBesideAt(const Activity& activity) const;
  // Reads a time on a reading thread, which passes its activity.
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
  // Returns the hanging read that blocks `read`. That is `read` itself or, before it begins,
  // another read on its storage.
  std::optional<HungRead> HoldsUp(const PendingRead& read);
  // Returns a requested read that hangs on the storage of that place.
  std::optional<HungRead> HungOnStorageOf(const Place& place);
  absl::StatusOr<std::optional<storm_files::VerticalGrid>> VerticalGridOf(Lock& lock,
                                                                          const Place& place);
  // Makes the grid the storm's, unless the storm has one.
  void Choose(const Place& place, const storm_files::VerticalGrid& grid);
  void WantAfter(const Place& place);
  std::optional<Place> NextWanted();
  bool IsWanted(const TimeKey& key) const;
  void TakeFound(const CatalogueScan::Result& found);
  StormChange Replace(std::size_t place, std::optional<CataloguedStorm> found);
  std::string FreeId(const std::string& wanted, std::size_t place) const;

  // Returns the delay after which a file that has just been replaced may be described.
  std::chrono::milliseconds ReplacedRetryAfter() const;
  absl::Status Checkpoint(PendingRead& read, Activity& activity, double share);
  // Runs queued reads until the end.
  void ReadDue(Activity& activity);
  // Waits until no other requested read is in progress, or until the end.
  void LetOthersEnd(Lock& lock, Activity& activity);
  void ReadAhead();

  void Start();
  void End();

  std::optional<std::chrono::steady_clock::time_point> OldestUnused() override;
  void DropOldestUnused() override;

  const StormStoreOptions options_;

  mutable std::mutex mutex_;
  std::deque<Held> storms_;          // elements are never removed: indices stay
  std::vector<std::size_t> order_;   // places of the listed storms
  std::condition_variable changed_;  // a read ended, a time was wanted, a caller waits, the first
                                     // search or the store ended
  FieldsCache cache_;
  std::map<TimeKey, std::shared_ptr<PendingRead>> pending_;
  std::deque<std::shared_ptr<PendingRead>> asked_;  // queued, in order
  std::array<Activity, 4> reading_asked_;           // one per thread that reads requested times
  Activity reading_ahead_;
  std::vector<TimeKey> wanted_;  // to be read ahead, in order
  int asked_reads_ = 0;
  bool ending_ = false;
  bool searching_ = false;  // true during the first search

  std::mutex listening_;  // held while the listener is called; locked before mutex_
  CatalogueListener listener_;
  bool following_ = false;  // changes are reported

  // These exist from Start to End.
  std::unique_ptr<LiveCatalogue> live_;
  std::optional<base::MemoryBudget::Member> member_;
  std::vector<base::LooseThread> threads_;
};

}  // namespace thunderhead::storm_store
