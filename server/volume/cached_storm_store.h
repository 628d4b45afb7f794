// The store that StormStore::Open gives: a catalogue, a cache, and a thread that reads ahead. A
// time is read once however many callers ask for it; reads that a caller waits for go before
// read-ahead.
#pragma once

#include <condition_variable>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string_view>
#include <thread>
#include <vector>

#include "volume/fields_cache.h"
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

  std::vector<const StormInfo*> Storms() const override;
  absl::StatusOr<const StormInfo*> Add(const std::string& path) override;
  absl::Status Remove(std::string_view id) override;
  absl::StatusOr<std::shared_ptr<const HydrometeorFields>> Get(
      std::string_view id, int time_index, const ReadProgress& progress) override;
  std::shared_ptr<const HydrometeorFields> Peek(std::string_view id, int time_index) override;
  std::size_t CachedBytes() const override;

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

  // All below are called with `lock` held on mutex_ and return with it held.
  using Lock = std::unique_lock<std::mutex>;
  std::optional<std::size_t> PlaceOf(std::string_view id) const;
  absl::Status NoSuchStorm(std::string_view id) const;
  absl::StatusOr<TimeKey> KeyOf(std::string_view id, int time_index) const;
  Fields Read(Lock& lock, const TimeKey& key, Purpose purpose, const ReadProgress& progress);
  Fields ReadFile(Lock& lock, const TimeKey& key, PendingRead& read);
  Fields WaitFor(Lock& lock, const std::shared_ptr<PendingRead>& read,
                 const ReadProgress& progress);
  std::optional<VerticalGrid> VerticalGridOf(Lock& lock, const TimeKey& key);
  void WantAfter(const TimeKey& key);
  std::optional<TimeKey> NextWanted();
  bool IsWanted(const TimeKey& key) const;

  absl::Status Checkpoint(const TimeKey& key, PendingRead& read, double share);
  void ReadAhead();

  const StormStoreOptions options_;

  mutable std::mutex mutex_;
  // Elements of both are never removed, so references to them stay valid.
  std::deque<CataloguedStorm> storms_;
  std::deque<std::optional<VerticalGrid>>
      vertical_grids_;             // one for each storm, the same for all its times
  std::set<std::size_t> removed_;  // of storms_
  std::condition_variable
      changed_;  // a read ended, a time was wanted, a caller waits, or the store ends
  FieldsCache cache_;
  std::map<TimeKey, std::shared_ptr<PendingRead>> pending_;
  std::vector<TimeKey> wanted_;  // to be read ahead, in order
  int asked_reads_ = 0;
  bool ending_ = false;

  std::thread read_ahead_;  // last member, so that it starts after all others are initialised
};

}  // namespace thunderhead::volume
