// The store behind what StormStore::Open gives: a catalogue, a cache, threads that read what is
// asked for, and one that reads ahead. A time is read once however many callers ask for it; reads
// that a caller waits for go before read-ahead, and before files that the catalogue looks at.
//
// Reads go one after another, since several at once would need the memory of several. Only while
// one takes long does another begin beside it, of another file. A storage that hangs holds up the
// threads that read from it, but never the last one, and no caller beyond the deadline.
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
  // Reads nothing until it is Owned.
  CachedStormStore(const std::vector<CataloguedStorm>& storms, const StormStoreOptions& options);

  // The store, whose threads run until the owner destroys it; one that hangs keeps it in memory.
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

  // Makes the storms of the paths those `found`, and tells the listener what has changed. Storms
  // that were added stay. A time whose file is gone stays while somebody holds its fields.
  void Renew(const std::vector<CataloguedStorm>& found);

  // Waits until no caller waits for a read, but not for ever.
  void LetReadersGoFirst();

  // Renews the store's storms from now on, as `scan` finds them.
  void Follow(std::unique_ptr<CatalogueScan> scan);
  // Returns whether the first search has ended, after LiveCatalogueOptions::first_search at most.
  bool AwaitFirstSearch();
  bool IsSearching() const override;

 private:
  class Handle;
  using Fields = absl::StatusOr<std::shared_ptr<const volume::HydrometeorFields>>;
  enum class Purpose { kAsked, kAhead };

  // A caller's listener, which is removed when the caller stops waiting.
  struct Listener {
    std::mutex mutex;  // held during a call; no lock is taken with it
    ReadProgress progress;
  };

  // A thread's read under way.
  struct Activity {
    bool reads = false;  // and does not pause
    std::string file;
    std::uint64_t device = 0;  // of that file
    std::chrono::steady_clock::time_point began;
    std::chrono::steady_clock::time_point went_on;  // since when nothing has come
    bool told_of_hang = false;
  };

  // The height grid of a storm, and the file of its first time when it was chosen.
  struct ChosenGrid {
    storm_files::VerticalGrid grid;
    std::string path;
    std::uint64_t version = 0;
  };

  // A storm and what the store keeps of it.
  struct Held {
    std::shared_ptr<const CataloguedStorm> storm;  // null: removed
    std::vector<int> numbers;                      // one for each time, never used again
    int next_number = 0;
    bool added = false;              // by Add, so not in the paths
    std::optional<ChosenGrid> grid;  // the same for all times

    StormInfoPtr Info() const { return {storm, &storm->info}; }
  };

  // A time and what it is read from, whatever becomes of the storm meanwhile.
  struct Place {
    TimeKey key;
    std::shared_ptr<const CataloguedStorm> storm;
    std::size_t time = 0;  // index into the storm's times
  };

  // A read that is due or in progress, shared by all callers that wait for it.
  struct PendingRead {
    Place place;
    Purpose purpose = Purpose::kAsked;
    Activity* activity = nullptr;  // of the thread that reads it, once it has begun
    int waiters = 0;               // callers that wait
    std::vector<std::shared_ptr<Listener>> listeners;
    std::optional<Fields> result;
  };

  // All below are called with `lock` held on mutex_ and return with it held.
  using Lock = std::unique_lock<std::mutex>;
  std::optional<std::size_t> PlaceOf(std::string_view id) const;
  absl::Status NoSuchStorm(std::string_view id) const;
  absl::StatusOr<Place> PlaceOf(std::string_view id, int time_index) const;
  std::optional<Place> PlaceOf(const TimeKey& key) const;
  std::shared_ptr<PendingRead> Begin(const Place& place, Purpose purpose);
  // The read of that time that is pending, or another one. An error if it would wait behind a
  // storage that hangs and is its own.
  absl::StatusOr<std::shared_ptr<PendingRead>> ReadOf(const Place& place);
  // True if that read may begin beside those under way.
  bool MayBegin(const PendingRead& read) const;
  // Takes the first read that may begin, if there is one.
  std::shared_ptr<PendingRead> TakeDue();
  // When another read may begin although this one has not ended.
  std::chrono::steady_clock::time_point MayReadBesideAt(const Activity& activity) const;
  // On a reading thread, whose activity is given.
  void Read(Lock& lock, PendingRead& read, Activity& activity);
  Fields ReadFile(Lock& lock, PendingRead& read, Activity& activity);
  Fields WaitFor(Lock& lock, const std::shared_ptr<PendingRead>& read,
                 const ReadProgress& progress);
  std::optional<HungRead> HungIn(const Activity& activity) const;
  // The same; the log tells of each once.
  std::optional<HungRead> NoteHang(Activity& activity) const;
  base::TimeSource::Clock::time_point Now() const { return options_.time->Now(); }
  // When the activity hangs unless it goes on.
  std::chrono::steady_clock::time_point HangsAt(const Activity& activity) const;
  // The read that hangs and keeps `read` from going on: itself, or one of its storage before it
  // begins.
  std::optional<HungRead> HoldsUp(const PendingRead& read);
  // A read that callers wait for and that hangs, of the storage of that place.
  std::optional<HungRead> HungOnStorageOf(const Place& place);
  absl::StatusOr<std::optional<storm_files::VerticalGrid>> VerticalGridOf(Lock& lock,
                                                                          const Place& place);
  // Makes it the storm's, if that has none.
  void Choose(const Place& place, const storm_files::VerticalGrid& grid);
  void WantAfter(const Place& place);
  std::optional<Place> NextWanted();
  bool IsWanted(const TimeKey& key) const;
  void TakeFound(const CatalogueScan::Result& found);
  StormChange Replace(std::size_t place, std::optional<CataloguedStorm> found);
  std::string FreeId(const std::string& wanted, std::size_t place) const;

  // When a file that has just been replaced may be described.
  std::chrono::milliseconds ReplacedRetryAfter() const;
  absl::Status Checkpoint(PendingRead& read, Activity& activity, double share);
  // Until the end, what is due.
  void ReadDue(Activity& activity);
  // Waits until no other read that callers wait for is under way, or the end.
  void LetOthersEnd(Lock& lock, Activity& activity);
  void ReadAhead();

  void Start();
  void End();

  std::optional<std::chrono::steady_clock::time_point> OldestUnused() override;
  void DropOldestUnused() override;

  const StormStoreOptions options_;

  mutable std::mutex mutex_;
  std::deque<Held> storms_;          // elements are never removed: indices stay
  std::vector<std::size_t> order_;   // of those that are listed
  std::condition_variable changed_;  // a read ended, a time was wanted, a caller waits, the first
                                     // search or the store ended
  FieldsCache cache_;
  std::map<TimeKey, std::shared_ptr<PendingRead>> pending_;
  std::deque<std::shared_ptr<PendingRead>> asked_;  // due, in order
  std::array<Activity, 4> reading_asked_;           // of each thread that reads what is asked for
  Activity reading_ahead_;
  std::vector<TimeKey> wanted_;  // to be read ahead, in order
  int asked_reads_ = 0;
  bool ending_ = false;
  bool searching_ = false;  // for the first time

  std::mutex listening_;  // held while the listener is called; before mutex_
  CatalogueListener listener_;
  bool following_ = false;  // changes are news

  // From Start to End.
  std::unique_ptr<LiveCatalogue> live_;
  std::optional<base::MemoryBudget::Member> member_;
  std::vector<base::LooseThread> threads_;
};

}  // namespace thunderhead::storm_store
