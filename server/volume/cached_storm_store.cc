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
    : options_(options),
      storms_(std::make_move_iterator(storms.begin()), std::make_move_iterator(storms.end())),
      vertical_grids_(storms_.size()),
      cache_(options.byte_budget) {
  if (options_.read_ahead > 0) read_ahead_ = std::thread([this] { ReadAhead(); });
}

CachedStormStore::~CachedStormStore() {
  {
    Lock lock(mutex_);
    ending_ = true;
  }
  changed_.notify_all();
  if (read_ahead_.joinable()) read_ahead_.join();
}

std::vector<const StormInfo*> CachedStormStore::Storms() const {
  const Lock lock(mutex_);
  std::vector<const StormInfo*> infos;
  for (std::size_t i = 0; i < storms_.size(); ++i) {
    if (!removed_.contains(i)) infos.push_back(&storms_[i].info);
  }
  return infos;
}

absl::StatusOr<const StormInfo*> CachedStormStore::Add(const std::string& path) {
  THUNDERHEAD_ASSIGN_OR_RETURN(std::vector<CataloguedStorm> found,
                               FindStorms({path}, options_.formats));
  CataloguedStorm& storm = found.front();
  const Lock lock(mutex_);
  if (PlaceOf(storm.info.id).has_value()) {
    return absl::AlreadyExistsError(absl::StrCat("cannot add ", path, ": there is a storm '",
                                                 storm.info.id, "' already; rename the file"));
  }
  vertical_grids_.emplace_back();
  return &storms_.emplace_back(std::move(storm)).info;
}

absl::Status CachedStormStore::Remove(std::string_view id) {
  {
    const Lock lock(mutex_);
    const std::optional<std::size_t> place = PlaceOf(id);
    if (!place.has_value()) return NoSuchStorm(id);
    removed_.insert(*place);
    cache_.RemoveStorm(*place);
    std::erase_if(wanted_, [&](const TimeKey& key) { return key.storm == *place; });
  }
  changed_.notify_all();
  return absl::OkStatus();
}

std::optional<std::size_t> CachedStormStore::PlaceOf(std::string_view id) const {
  for (std::size_t i = 0; i < storms_.size(); ++i) {
    if (storms_[i].info.id == id && !removed_.contains(i)) return i;
  }
  return std::nullopt;
}

absl::Status CachedStormStore::NoSuchStorm(std::string_view id) const {
  std::vector<std::string> ids;
  for (std::size_t i = 0; i < storms_.size(); ++i) {
    if (!removed_.contains(i)) ids.push_back(storms_[i].info.id);
  }
  return absl::NotFoundError(absl::StrCat("there is no storm '", std::string(id),
                                          "'; the storms are ", absl::StrJoin(ids, ", ")));
}

absl::StatusOr<TimeKey> CachedStormStore::KeyOf(std::string_view id, int time_index) const {
  const std::optional<std::size_t> place = PlaceOf(id);
  if (!place.has_value()) return NoSuchStorm(id);
  const StormInfo& info = storms_[*place].info;
  const std::size_t times = info.times.size();
  if (time_index < 0 || static_cast<std::size_t>(time_index) >= times) {
    return absl::OutOfRangeError(absl::StrCat("storm '", info.id, "' has no time ", time_index,
                                              "; its times are 0 to ", times - 1));
  }
  return TimeKey{*place, time_index};
}

absl::StatusOr<std::shared_ptr<const HydrometeorFields>> CachedStormStore::Get(
    std::string_view id, int time_index, const ReadProgress& progress) {
  Lock lock(mutex_);
  THUNDERHEAD_ASSIGN_OR_RETURN(const TimeKey key, KeyOf(id, time_index));
  while (true) {
    Fields fields = cache_.Use(key);
    if (*fields == nullptr) {
      const auto at = pending_.find(key);
      fields = at != pending_.end() ? WaitFor(lock, at->second, progress)
                                    : Read(lock, key, Purpose::kAsked, progress);
    }
    // The read may have been a read-ahead that was cancelled just now: try again.
    if (absl::IsCancelled(fields.status()) && !ending_) continue;
    if (fields.ok()) {
      cache_.Use(key);
      WantAfter(key);
    }
    return fields;
  }
}

std::shared_ptr<const HydrometeorFields> CachedStormStore::Peek(std::string_view id,
                                                                int time_index) {
  const Lock lock(mutex_);
  const absl::StatusOr<TimeKey> key = KeyOf(id, time_index);
  if (!key.ok()) return nullptr;
  return cache_.Use(*key);
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

CachedStormStore::Fields CachedStormStore::Read(Lock& lock, const TimeKey& key, Purpose purpose,
                                                const ReadProgress& progress) {
  const auto read = std::make_shared<PendingRead>();
  read->purpose = purpose;
  if (progress) read->listeners.push_back(progress);
  pending_[key] = read;
  if (purpose == Purpose::kAsked) ++asked_reads_;
  Fields fields = ReadFile(lock, key, *read);
  if (purpose == Purpose::kAsked) --asked_reads_;
  // Fields of a storm that was removed meanwhile are returned to callers but not cached.
  const bool keep = fields.ok() && !removed_.contains(key.storm);
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

CachedStormStore::Fields CachedStormStore::ReadFile(Lock& lock, const TimeKey& key,
                                                    PendingRead& read) {
  const CataloguedStorm& storm = storms_[key.storm];
  const TimeSource source = storm.sources[key.time];
  const std::optional<VerticalGrid> grid = VerticalGridOf(lock, key);
  lock.unlock();
  absl::StatusOr<HydrometeorFields> fields = storm.files[source.file].reader->Read(
      source.record, grid, [&](double share) { return Checkpoint(key, read, share); });
  lock.lock();
  if (!fields.ok()) return fields.status();
  if (!vertical_grids_[key.storm].has_value()) {
    const RegularGrid& chosen = fields->grid;
    vertical_grids_[key.storm] =
        VerticalGrid{chosen.low_corner_m.z, chosen.spacing_m.z, chosen.cells.z};
  }
  return std::make_shared<const HydrometeorFields>(*std::move(fields));
}

// The storm's height grid comes from its first time, whichever time is read first, so that a time's
// picture does not depend on which times were viewed before. Nothing if this is the first time
// itself, or if the first cannot be read.
std::optional<VerticalGrid> CachedStormStore::VerticalGridOf(Lock& lock, const TimeKey& key) {
  std::optional<VerticalGrid>& grid = vertical_grids_[key.storm];
  if (grid.has_value() || key.time == 0) return grid;
  const CataloguedStorm& storm = storms_[key.storm];
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

void CachedStormStore::WantAfter(const TimeKey& key) {
  wanted_.clear();
  if (removed_.contains(key.storm)) return;
  const int times = static_cast<int>(storms_[key.storm].info.times.size());
  std::size_t bytes = cache_.NewestBytes();
  for (int time = key.time + 1; time < times && time <= key.time + options_.read_ahead; ++time) {
    // Do not read a time that would evict the one in view; all times are taken to be equally large.
    bytes += cache_.NewestBytes();
    if (bytes > options_.byte_budget) break;
    wanted_.push_back({key.storm, time});
  }
  changed_.notify_all();
}

std::optional<TimeKey> CachedStormStore::NextWanted() {
  const auto at = std::ranges::find_if(wanted_, [this](const TimeKey& key) {
    return !cache_.Holds(key) && !pending_.contains(key);
  });
  return at == wanted_.end() ? std::nullopt : std::optional(*at);
}

void CachedStormStore::ReadAhead() {
  Lock lock(mutex_);
  while (!ending_) {
    const std::optional<TimeKey> key = NextWanted();
    if (!key.has_value()) {
      changed_.wait(lock);
      continue;
    }
    const Fields fields = Read(lock, *key, Purpose::kAhead, {});
    std::erase(wanted_, *key);
    if (!fields.ok() && !absl::IsCancelled(fields.status())) {
      spdlog::warn("reading ahead: {}", std::string(fields.status().message()));
    }
  }
}

}  // namespace thunderhead::volume
