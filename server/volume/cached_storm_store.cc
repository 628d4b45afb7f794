#include "volume/cached_storm_store.h"

#include <algorithm>
#include <iterator>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "base/status.h"
#include "spdlog/spdlog.h"

namespace thunderhead::volume {

CachedStormStore::CachedStormStore(std::vector<CataloguedStorm> storms,
                                   const StormStoreOptions& options)
    : options_(options), cache_(options.byte_budget) {
  Renew(storms);
  if (options_.read_ahead > 0) read_ahead_ = std::thread([this] { ReadAhead(); });
}

CachedStormStore::~CachedStormStore() {
  {
    Lock lock(mutex_);
    ending_ = true;
  }
  changed_.notify_all();
  live_.reset();
  if (read_ahead_.joinable()) read_ahead_.join();
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
  CataloguedStorm& storm = found.front();
  const Lock lock(mutex_);
  if (PlaceOf(storm.info.id).has_value()) {
    return absl::AlreadyExistsError(absl::StrCat("cannot add ", path, ": there is a storm '",
                                                 storm.info.id, "' already; rename the file"));
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
    std::erase(order_, *place);
    cache_.RemoveStorm(*place);
    std::erase_if(wanted_, [&](const TimeKey& key) { return key.storm == *place; });
  }
  changed_.notify_all();
  return absl::OkStatus();
}

std::optional<std::size_t> CachedStormStore::PlaceOf(std::string_view id) const {
  const auto at = std::ranges::find_if(storms_, [&](const Held& held) {
    return held.storm != nullptr && held.storm->info.id == id;
  });
  if (at == storms_.end()) return std::nullopt;
  return static_cast<std::size_t>(at - storms_.begin());
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

absl::StatusOr<std::shared_ptr<const HydrometeorFields>> CachedStormStore::Get(
    std::string_view id, int time_index, const ReadProgress& progress) {
  Lock lock(mutex_);
  THUNDERHEAD_ASSIGN_OR_RETURN(const Place place, PlaceOf(id, time_index));
  while (true) {
    Fields fields = cache_.Use(place.key);
    if (*fields == nullptr) {
      const auto at = pending_.find(place.key);
      fields = at != pending_.end() ? WaitFor(lock, at->second, progress)
                                    : Read(lock, place, Purpose::kAsked, progress);
    }
    // The read may have been a read-ahead that was cancelled just now: try again.
    if (absl::IsCancelled(fields.status()) && !ending_) continue;
    if (fields.ok()) {
      cache_.Use(place.key);
      WantAfter(place);
    }
    return fields;
  }
}

std::shared_ptr<const HydrometeorFields> CachedStormStore::Peek(std::string_view id,
                                                                int time_index) {
  const Lock lock(mutex_);
  const absl::StatusOr<Place> place = PlaceOf(id, time_index);
  if (!place.ok()) return nullptr;
  return cache_.Use(place->key);
}

std::size_t CachedStormStore::CachedBytes() const {
  Lock lock(mutex_);
  return cache_.Bytes();
}

CachedStormStore::Fields CachedStormStore::WaitFor(Lock& lock,
                                                   const std::shared_ptr<PendingRead>& read,
                                                   const ReadProgress& progress) {
  const std::shared_ptr<PendingRead> shared =
      read;  // keeps it alive after its removal from pending_
  ++shared->waiters;
  if (progress) shared->listeners.push_back(progress);
  changed_.notify_all();  // a paused read-ahead of this time may now go on
  changed_.wait(lock, [&shared] { return shared->result.has_value(); });
  return *shared->result;
}

CachedStormStore::Fields CachedStormStore::Read(Lock& lock, const Place& place, Purpose purpose,
                                                const ReadProgress& progress) {
  const TimeKey& key = place.key;
  const auto read = std::make_shared<PendingRead>();
  read->purpose = purpose;
  if (progress) read->listeners.push_back(progress);
  pending_[key] = read;
  if (purpose == Purpose::kAsked) ++asked_reads_;
  Fields fields = ReadFile(lock, place, *read);
  if (purpose == Purpose::kAsked) --asked_reads_;
  // Fields of a time that was removed meanwhile are returned to callers but not cached.
  const bool keep = fields.ok() && PlaceOf(key).has_value();
  if (keep && (purpose == Purpose::kAsked || read->waiters > 0)) {
    cache_.Insert(key, *fields);
  } else if (keep) {
    cache_.InsertAhead(key, *fields);
  }
  pending_.erase(key);
  read->result = fields;
  changed_.notify_all();
  return fields;
}

CachedStormStore::Fields CachedStormStore::ReadFile(Lock& lock, const Place& place,
                                                    PendingRead& read) {
  const TimeSource source = place.storm->sources[place.time];
  const std::optional<VerticalGrid> grid = VerticalGridOf(lock, place);
  lock.unlock();
  absl::StatusOr<HydrometeorFields> fields = place.storm->files[source.file].reader->Read(
      source.record, grid, [&](double share) { return Checkpoint(place.key, read, share); });
  lock.lock();
  if (!fields.ok()) return fields.status();
  std::optional<VerticalGrid>& chosen = storms_[place.key.storm].grid;
  if (!chosen.has_value()) {
    const RegularGrid& used = fields->grid;
    chosen = VerticalGrid{used.low_corner_m.z, used.spacing_m.z, used.cells.z};
  }
  return std::make_shared<const HydrometeorFields>(*std::move(fields));
}

// The storm's height grid comes from its first time, whichever time is read first, so that a time's
// picture does not depend on which times were viewed before. It stays when an earlier time arrives
// later. Nothing if this is the first time itself, or if the first cannot be read.
std::optional<VerticalGrid> CachedStormStore::VerticalGridOf(Lock& lock, const Place& place) {
  std::optional<VerticalGrid>& grid = storms_[place.key.storm].grid;
  if (grid.has_value() || place.time == 0) return grid;
  const CataloguedStorm& storm = *place.storm;
  const TimeSource first = storm.sources.front();
  lock.unlock();
  const absl::StatusOr<VerticalGrid> chosen =
      storm.files[first.file].reader->ReadVerticalGrid(first.record);
  lock.lock();
  if (!chosen.ok()) {
    spdlog::warn("the first time of {} cannot be read: {}", storm.info.id,
                 std::string(chosen.status().message()));
  } else if (!grid.has_value()) {
    grid = *chosen;
  }
  return grid;
}

absl::Status CachedStormStore::Checkpoint(const TimeKey& key, PendingRead& read, double share) {
  Lock lock(mutex_);
  if (read.purpose == Purpose::kAhead) {
    const auto unwanted = [&] { return read.waiters == 0 && !IsWanted(key); };
    changed_.wait(lock,
                  [&] { return ending_ || read.waiters > 0 || asked_reads_ == 0 || unwanted(); });
    if (ending_ || unwanted()) return absl::CancelledError("read-ahead was cancelled");
  }
  const std::vector<ReadProgress> listeners = read.listeners;
  lock.unlock();
  for (const ReadProgress& listener : listeners) listener(share);
  return absl::OkStatus();
}

bool CachedStormStore::IsWanted(const TimeKey& key) const {
  return std::ranges::find(wanted_, key) != wanted_.end();
}

void CachedStormStore::WantAfter(const Place& place) {
  wanted_.clear();
  const Held& held = storms_[place.key.storm];
  const auto at = std::ranges::find(held.numbers, place.key.time);
  if (held.storm == nullptr || at == held.numbers.end()) return;
  std::size_t bytes = cache_.NewestBytes();
  int ahead = 0;
  for (auto next = at + 1; next != held.numbers.end() && ahead < options_.read_ahead;
       ++next, ++ahead) {
    // Do not read a time that would evict the one in view; all times are taken to be equally large.
    bytes += cache_.NewestBytes();
    if (bytes > options_.byte_budget) break;
    wanted_.push_back({place.key.storm, *next});
  }
  changed_.notify_all();
}

std::optional<CachedStormStore::Place> CachedStormStore::NextWanted() {
  for (const TimeKey& key : wanted_) {
    if (!cache_.Holds(key) && !pending_.contains(key)) return PlaceOf(key);
  }
  return std::nullopt;
}

void CachedStormStore::ReadAhead() {
  Lock lock(mutex_);
  while (!ending_) {
    const std::optional<Place> place = NextWanted();
    if (!place.has_value()) {
      changed_.wait(lock);
      continue;
    }
    const Fields fields = Read(lock, *place, Purpose::kAhead, {});
    std::erase(wanted_, place->key);
    if (!fields.ok() && !absl::IsCancelled(fields.status())) {
      spdlog::warn("reading ahead: {}", std::string(fields.status().message()));
    }
  }
}

}  // namespace thunderhead::volume
