#include "storm_store/cached_storm_store.h"

#include <algorithm>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "base/status.h"
#include "spdlog/spdlog.h"

namespace thunderhead::storm_store {

// An owner that ends the store's threads when it is destroyed.
class CachedStormStore::Handle final : public StormStore {
 public:
  explicit Handle(std::shared_ptr<CachedStormStore> store) : store_(std::move(store)) {
    store_->Start();
  }
  ~Handle() override { store_->End(); }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;

  std::vector<StormInfoPtr> Storms() const override { return store_->Storms(); }
  absl::StatusOr<StormInfoPtr> Add(const std::string& path) override { return store_->Add(path); }
  absl::Status Remove(std::string_view id) override { return store_->Remove(id); }
  absl::StatusOr<std::shared_ptr<const volume::HydrometeorFields>> Get(
      std::string_view id, int time_index, const ReadProgress& progress) override {
    return store_->Get(id, time_index, progress);
  }
  std::shared_ptr<const volume::HydrometeorFields> Peek(std::string_view id,
                                                        int time_index) override {
    return store_->Peek(id, time_index);
  }
  std::vector<int> TimesInMemory(std::string_view id) const override {
    return store_->TimesInMemory(id);
  }
  std::size_t CachedBytes() const override { return store_->CachedBytes(); }
  bool IsSearching() const override { return store_->IsSearching(); }
  void Listen(CatalogueListener listener) override { store_->Listen(std::move(listener)); }
  std::size_t PendingReads() const override { return store_->PendingReads(); }
  std::optional<HungRead> Hung() const override { return store_->Hung(); }

 private:
  const std::shared_ptr<CachedStormStore> store_;
};

std::unique_ptr<StormStore> CachedStormStore::Owned(std::shared_ptr<CachedStormStore> store) {
  return std::make_unique<Handle>(std::move(store));
}

CachedStormStore::CachedStormStore(const std::vector<CataloguedStorm>& storms,
                                   const StormStoreOptions& options)
    : options_(options),
      earlier_ids_(options.live.has_value() ? options.live->ids : ""),
      cache_(options.byte_budget),
      kept_ids_(earlier_ids_) {
  Renew(storms);
}

void CachedStormStore::Start() {
  if (options_.memory != nullptr) {
    member_.emplace(options_.memory, static_cast<base::MemoryBudget::Cache*>(this));
  }
  for (Activity& activity : reading_asked_) {
    threads_.emplace_back(
        "reading a storm", [self = shared_from_this(), &activity] { self->ReadDue(activity); },
        *options_.time);
  }
  if (options_.read_ahead == 0) return;
  threads_.emplace_back(
      "reading ahead", [self = shared_from_this()] { self->ReadAhead(); }, *options_.time);
}

void CachedStormStore::End() {
  {
    Lock lock(mutex_);
    ending_ = true;
  }
  changed_.notify_all();
  live_.reset();
  threads_.clear();
  member_.reset();
}

std::size_t CachedStormStore::PendingReads() const {
  const Lock lock(mutex_);
  return pending_.size();
}

std::vector<StormInfoPtr> CachedStormStore::Storms() const {
  const Lock lock(mutex_);
  std::vector<StormInfoPtr> infos;
  infos.reserve(order_.size());
  for (const std::size_t i : order_) infos.push_back(storms_[i].Info());
  return infos;
}

absl::StatusOr<StormInfoPtr> CachedStormStore::Add(const std::string& path) {
  THUNDERHEAD_ASSIGN_OR_RETURN(std::vector<CataloguedStorm> found,
                               FindStorms({path}, options_.formats));
  if (found.size() > 1) {
    return absl::InvalidArgumentError(absl::StrCat(
        "cannot add ", path, ": it has ", found.size(), " storms, from '", found.front().info.id,
        "' to '", found.back().info.id, "', and a file that is added must have one; split it"));
  }
  CataloguedStorm& storm = found.front();
  const Lock lock(mutex_);
  if (owners_.contains(storm.info.id)) {
    return absl::AlreadyExistsError(absl::StrCat(
        "cannot add ", path, ": another storm has the id '", storm.info.id, "'; rename the file"));
  }
  order_.push_back(storms_.size());
  Held& held = storms_.emplace_back();
  held.added = true;
  return Replace(storms_.size() - 1, std::move(storm)).after;
}

absl::Status CachedStormStore::Remove(std::string_view id) {
  {
    const Lock lock(mutex_);
    const std::optional<std::size_t> place = PlaceOf(id);
    if (!place.has_value()) return NoSuchStorm(id);
    storms_[*place].storm.reset();
    ReleaseIds(*place);
    std::erase(order_, *place);
    cache_.RemoveStorm(*place);
    std::erase_if(wanted_, [&](const TimeKey& key) { return key.storm == *place; });
  }
  changed_.notify_all();
  return absl::OkStatus();
}

std::optional<std::size_t> CachedStormStore::PlaceOf(std::string_view id) const {
  const auto owner = owners_.find(id);
  if (owner == owners_.end() || storms_[owner->second].storm->info.id != id) return std::nullopt;
  return owner->second;
}

absl::Status CachedStormStore::NoSuchStorm(std::string_view id) const {
  std::vector<std::string> ids;
  ids.reserve(order_.size());
  for (const std::size_t place : order_) ids.push_back(storms_[place].storm->info.id);
  return absl::NotFoundError(absl::StrCat("there is no storm '", std::string(id),
                                          "'; the storms are ", absl::StrJoin(ids, ", ")));
}

absl::StatusOr<CachedStormStore::Place> CachedStormStore::PlaceOf(std::string_view id,
                                                                  int time_index) const {
  const std::optional<std::size_t> place = PlaceOf(id);
  if (!place.has_value()) return NoSuchStorm(id);
  const Held& held = storms_[*place];
  const std::size_t times = held.numbers.size();
  if (time_index < 0 || static_cast<std::size_t>(time_index) >= times) {
    return absl::OutOfRangeError(absl::StrCat("storm '", held.storm->info.id, "' has no time ",
                                              time_index, "; its times are 0 to ", times - 1));
  }
  const auto time = static_cast<std::size_t>(time_index);
  return Place{{*place, held.numbers[time]}, held.storm, time};
}

std::optional<CachedStormStore::Place> CachedStormStore::PlaceOf(const TimeKey& key) const {
  const Held& held = storms_[key.storm];
  const auto at = std::ranges::find(held.numbers, key.time);
  if (held.storm == nullptr || at == held.numbers.end()) return std::nullopt;
  return Place{key, held.storm, static_cast<std::size_t>(at - held.numbers.begin())};
}

std::shared_ptr<const volume::HydrometeorFields> CachedStormStore::Peek(std::string_view id,
                                                                        int time_index) {
  const Lock lock(mutex_);
  const absl::StatusOr<Place> place = PlaceOf(id, time_index);
  if (!place.ok()) return nullptr;
  return cache_.Use(place->key);
}

std::vector<int> CachedStormStore::TimesInMemory(std::string_view id) const {
  const Lock lock(mutex_);
  std::vector<int> times;
  const std::optional<std::size_t> place = PlaceOf(id);
  if (!place.has_value()) return times;
  const std::vector<int>& numbers = storms_[*place].numbers;
  for (std::size_t time = 0; time < numbers.size(); ++time) {
    if (cache_.Holds({*place, numbers[time]})) times.push_back(static_cast<int>(time));
  }
  return times;
}

std::size_t CachedStormStore::CachedBytes() const {
  Lock lock(mutex_);
  return cache_.Bytes();
}

std::optional<std::chrono::steady_clock::time_point> CachedStormStore::OldestUnused() {
  const Lock lock(mutex_);
  return cache_.OldestUnused();
}

void CachedStormStore::DropOldestUnused() {
  std::shared_ptr<const volume::HydrometeorFields> dropped;  // freed after the lock is released
  const Lock lock(mutex_);
  dropped = cache_.TakeOldestUnused();
}

}  // namespace thunderhead::storm_store
