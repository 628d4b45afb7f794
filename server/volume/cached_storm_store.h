// The store that StormStore::Open gives: a catalogue, a cache, and a thread that reads ahead. A
// time is read once however many callers ask for it; reads that a caller waits for go before
// read-ahead, and before files that the catalogue looks at.
#pragma once

#include <condition_variable>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "volume/fields_cache.h"
#include "volume/live_catalogue.h"
#include "volume/storm_catalogue.h"
#include "volume/storm_store.h"
#include "volume/vertical_remap.h"

namespace thunderhead::volume {

class CachedStormStore final : public StormStore {
 public:
  CachedStormStore(std::vector<CataloguedStorm> storms, const StormStoreOptions& options);
  ~CachedStormStore() override;

  CachedStormStore(const CachedStormStore&) = delete;
  CachedStormStore& operator=(const CachedStormStore&) = delete;

  std::vector<StormInfoPtr> Storms() const override;
  absl::StatusOr<StormInfoPtr> Add(const std::string& path) override;
  absl::Status Remove(std::string_view id) override;
  absl::StatusOr<std::shared_ptr<const HydrometeorFields>> Get(
      std::string_view id, int time_index, const ReadProgress& progress) override;
  std::shared_ptr<const HydrometeorFields> Peek(std::string_view id, int time_index) override;
  std::size_t CachedBytes() const override;
  void Listen(CatalogueListener listener) override;

  // Makes the storms of the paths those `found`, and tells the listener what has changed. Storms
  // that were added stay. A time whose file is gone stays while somebody holds its fields.
  void Renew(const std::vector<CataloguedStorm>& found);

  // Waits until no caller waits for a read, but not for ever.
  void LetReadersGoFirst();

  // Renews the store's storms from now on, as `scan` finds them.
  void Follow(std::unique_ptr<CatalogueScan> scan, CatalogueScan::Result first);

 private:
  using Fields = absl::StatusOr<std::shared_ptr<const HydrometeorFields>>;
  enum class Purpose { kAsked, kAhead };

  // A read in progress, shared by all callers that wait for it.
  struct PendingRead {
    Purpose purpose = Purpose::kAsked;
    int waiters = 0;  // callers that wait, besides the reading thread
    std::vector<ReadProgress> listeners;
    std::optional<Fields> result;
  };

  // A storm and what the store keeps of it.
  struct Held {
    std::shared_ptr<const CataloguedStorm> storm;  // null: removed
    std::vector<int> numbers;                      // one for each time, never used again
    int next_number = 0;
    bool added = false;                // by Add, so not in the paths
    std::optional<VerticalGrid> grid;  // the same for all times

    StormInfoPtr Info() const { return {storm, &storm->info}; }
  };

  // A time and what it is read from, whatever becomes of the storm meanwhile.
  struct Place {
    TimeKey key;
    std::shared_ptr<const CataloguedStorm> storm;
    std::size_t time = 0;  // index into the storm's times
  };

  // All below are called with `lock` held on mutex_ and return with it held.
  using Lock = std::unique_lock<std::mutex>;
  std::optional<std::size_t> PlaceOf(std::string_view id) const;
  absl::Status NoSuchStorm(std::string_view id) const;
  absl::StatusOr<Place> PlaceOf(std::string_view id, int time_index) const;
  std::optional<Place> PlaceOf(const TimeKey& key) const;
  Fields Read(Lock& lock, const Place& place, Purpose purpose, const ReadProgress& progress);
  Fields ReadFile(Lock& lock, const Place& place, PendingRead& read);
  Fields WaitFor(Lock& lock, const std::shared_ptr<PendingRead>& read,
                 const ReadProgress& progress);
  std::optional<VerticalGrid> VerticalGridOf(Lock& lock, const Place& place);
  void WantAfter(const Place& place);
  std::optional<Place> NextWanted();
  bool IsWanted(const TimeKey& key) const;
  StormChange Replace(std::size_t place, std::optional<CataloguedStorm> found);
  std::string FreeId(const std::string& wanted, std::size_t place) const;

  absl::Status Checkpoint(const TimeKey& key, PendingRead& read, double share);
  void ReadAhead();

  const StormStoreOptions options_;

  mutable std::mutex mutex_;
  std::deque<Held> storms_;         // elements are never removed: indices stay
  std::vector<std::size_t> order_;  // of those that are listed
  std::condition_variable
      changed_;  // a read ended, a time was wanted, a caller waits, or the store ends
  FieldsCache cache_;
  std::map<TimeKey, std::shared_ptr<PendingRead>> pending_;
  std::vector<TimeKey> wanted_;  // to be read ahead, in order
  int asked_reads_ = 0;
  bool ending_ = false;

  std::mutex listening_;  // held while the listener is called; before mutex_
  CatalogueListener listener_;
  bool following_ = false;  // changes are news

  // Last members, so that they start after all others are initialised.
  std::thread read_ahead_;
  std::unique_ptr<LiveCatalogue> live_;
};

}  // namespace thunderhead::volume
