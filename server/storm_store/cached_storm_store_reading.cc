// The part of CachedStormStore that reads requested times and reads ahead.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>
#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/error_details.h"
#include "base/file_stamp.h"
#include "base/status.h"
#include "spdlog/spdlog.h"
#include "storm_store/border_data.h"
#include "storm_store/cached_storm_store.h"

namespace thunderhead::storm_store {
namespace {

namespace fs = std::filesystem;
using std::chrono::duration;
using std::chrono::steady_clock;

// If a read takes longer than this, a read of another file may begin in parallel.
constexpr std::chrono::seconds kTakesLong{5};

// The interval at which the read-ahead thread checks whether a hanging storage responds again.
constexpr std::chrono::milliseconds kLookAgain{500};

// Retry delay for a time on a storage that hangs.
constexpr std::chrono::seconds kRetryAfter{10};

// The estimated time to describe a file, once it counts as complete.
constexpr std::chrono::seconds kToDescribe{1};

constexpr std::string_view kReplaced = "FILE_REPLACED";

// Returns the product, or the largest value if it overflows.
std::size_t SaturatingProduct(std::size_t a, std::size_t b) {
  constexpr std::size_t kMax = std::numeric_limits<std::size_t>::max();
  return a != 0 && b > kMax / a ? kMax : a * b;
}

// The memory in bytes for reading a time, estimated from the description of its file.
struct ReadMemory {
  std::size_t fields = 0;
  std::size_t scratch = 0;  // needed only while reading
};

ReadMemory MemoryFor(const storm_files::StormFile& file,
                     const std::optional<storm_files::VerticalGrid>& grid) {
  // Each field takes a float and a half float (particle size) for each cell. The air's motion takes
  // two bytes for each cell.
  const std::size_t per_cell = file.fields.size() * 6 + 2;
  // There are about ten arrays such as pressure, temperature and heights, each with a float for
  // each cell of the file.
  constexpr std::size_t kScratch = 10 * sizeof(float);
  const auto columns = SaturatingProduct(static_cast<std::size_t>(file.cells.x),
                                         static_cast<std::size_t>(file.cells.y));
  const auto levels = static_cast<std::size_t>(file.cells.z);
  // ChooseVerticalGrid takes at most 1.25 times as many cells as levels.
  const std::size_t cells =
      grid.has_value() ? static_cast<std::size_t>(grid->cells) : levels + levels / 4 + 1;
  return {SaturatingProduct(SaturatingProduct(columns, cells), per_cell),
          SaturatingProduct(SaturatingProduct(columns, levels), kScratch)};
}

absl::Status Hangs(const HungRead& hung) {
  return base::WithDetails(
      absl::DeadlineExceededError(
          absl::StrCat(hung.file, ": no data has arrived for ", std::lround(hung.seconds),
                       " s because its storage does not respond; check the storage; times in "
                       "memory can still be shown")),
      {.reason = "STORAGE_HANGS", .metadata = {{"file", hung.file}}, .retry_after = kRetryAfter});
}

// Returns an error if the path now leads to another file than the described file, because the other
// file may have other times.
absl::Status CheckNotReplaced(const storm_files::StormFile& file,
                              std::chrono::milliseconds retry_after) {
  const std::optional<base::FileStamp> now = file.id != 0 ? base::StampOf(file.path) : std::nullopt;
  if (!now.has_value() || now->Id() == file.id) return absl::OkStatus();
  return base::WithDetails(
      absl::UnavailableError(absl::StrCat(
          file.path,
          ": was replaced by another file, which has not been read yet; try again in a "
          "few seconds")),
      {.reason = std::string(kReplaced),
       .metadata = {{"file", file.path}},
       .retry_after = retry_after});
}

// Returns whether `file` is on the same storage as the file with the given `path` and `device`. It
// is if both have the same device or, if a device is unknown, are in the same folder.
bool AreOfOneStorage(const storm_files::StormFile& file, const std::string& path,
                     std::uint64_t device) {
  if (file.device != 0 && device != 0) return file.device == device;
  return fs::path(file.path).parent_path() == fs::path(path).parent_path();
}

// Returns the index of the first time whose file still exists. The file of a deleted time cannot be
// read, and another file may have its path. Returns 0 if all times are deleted.
std::size_t FirstTimeThere(const StormInfo& storm) {
  const auto first = std::ranges::find(storm.times, false, &StormTime::deleted);
  return first == storm.times.end() ? 0 : static_cast<std::size_t>(first - storm.times.begin());
}

// Fields and the reservation of their memory, which lasts as long as the fields are in use.
struct CountedFields {
  volume::HydrometeorFields fields;
  base::MemoryReservation reserved;
};

}  // namespace

absl::StatusOr<std::shared_ptr<const volume::HydrometeorFields>> CachedStormStore::Get(
    std::string_view id, int time_index, const ReadProgress& progress) {
  Lock lock(mutex_);
  THUNDERHEAD_ASSIGN_OR_RETURN(Place place, PlaceOf(id, time_index));
  while (true) {
    Fields fields = cache_.Use(place.key);
    if (*fields == nullptr) {
      THUNDERHEAD_ASSIGN_OR_RETURN(const std::shared_ptr<PendingRead> read, ReadOf(place));
      fields = WaitFor(lock, read, progress);
    }
    // The read may have been a read-ahead that was cancelled just now, so try again.
    if (absl::IsCancelled(fields.status()) && !ending_) continue;
    if (base::DetailsOf(fields.status()).reason == kReplaced) {
      // The catalogue may have described the new file meanwhile.
      THUNDERHEAD_ASSIGN_OR_RETURN(Place now, PlaceOf(id, time_index));
      const bool described = now.key != place.key;
      place = std::move(now);
      if (described) continue;
    }
    if (fields.ok()) {
      cache_.Use(place.key);
      WantAfter(place);
    }
    return fields;
  }
}

std::shared_ptr<CachedStormStore::PendingRead> CachedStormStore::Begin(const Place& place,
                                                                       Purpose purpose) {
  auto read = std::make_shared<PendingRead>();
  read->place = place;
  read->purpose = purpose;
  pending_[place.key] = read;
  if (purpose == Purpose::kAsked) {
    asked_.push_back(read);
    ++asked_reads_;
  }
  return read;
}

absl::StatusOr<std::shared_ptr<CachedStormStore::PendingRead>> CachedStormStore::ReadOf(
    const Place& place) {
  if (const auto at = pending_.find(place.key); at != pending_.end()) return at->second;
  NoteHang(reading_ahead_);
  if (const std::optional<HungRead> hung = HungOnStorageOf(place); hung.has_value()) {
    return Hangs(*hung);
  }
  return Begin(place, Purpose::kAsked);
}

CachedStormStore::Fields CachedStormStore::WaitFor(Lock& lock,
                                                   const std::shared_ptr<PendingRead>& read,
                                                   const ReadProgress& progress) {
  const auto listener = std::make_shared<Listener>();
  listener->progress = progress;
  ++read->waiters;
  if (progress) read->listeners.push_back(listener);
  changed_.notify_all();  // wakes the reading thread, or a paused read-ahead
  while (!read->result.has_value()) {
    const std::optional<HungRead> hung = HoldsUp(*read);
    if (ending_ || hung.has_value()) {
      --read->waiters;
      lock.unlock();
      {
        const std::lock_guard calling(listener->mutex);
        listener->progress = {};
      }
      lock.lock();
      if (hung.has_value()) return Hangs(*hung);
      return absl::CancelledError("the store of storms has ended");
    }
    steady_clock::time_point next = Now() + options_.read_deadline;
    for (const Activity& activity : reading_asked_) next = std::min(next, HangsAt(activity));
    if (read->activity != nullptr) next = HangsAt(*read->activity);
    changed_.wait_until(lock, options_.time->LookAgainAt(next + std::chrono::milliseconds(1)));
  }
  return *read->result;
}

std::optional<HungRead> CachedStormStore::HoldsUp(const PendingRead& read) {
  return read.activity != nullptr ? NoteHang(*read.activity) : HungOnStorageOf(read.place);
}

std::optional<HungRead> CachedStormStore::HungOnStorageOf(const Place& place) {
  for (Activity& activity : reading_asked_) {
    std::optional<HungRead> hung = NoteHang(activity);
    if (hung.has_value() &&
        AreOfOneStorage(FileOf(*place.storm, place.time), hung->file, hung->device)) {
      return hung;
    }
  }
  return std::nullopt;
}

bool CachedStormStore::MayBegin(const PendingRead& read) const {
  const storm_files::StormFile& file = FileOf(*read.place.storm, read.place.time);
  std::size_t of_its_storage = 0;
  for (const Activity& other : reading_asked_) {
    if (!other.reads) continue;
    if (other.file == file.path || Now() < MayReadBesideAt(other)) return false;
    if (AreOfOneStorage(file, other.file, other.device)) ++of_its_storage;
  }
  return of_its_storage + 1 < reading_asked_.size();
}

steady_clock::time_point CachedStormStore::MayReadBesideAt(const Activity& activity) const {
  return activity.began + std::min<std::chrono::nanoseconds>(kTakesLong, options_.read_deadline);
}

std::shared_ptr<CachedStormStore::PendingRead> CachedStormStore::TakeDue() {
  const auto due = std::ranges::find_if(
      asked_, [this](const std::shared_ptr<PendingRead>& read) { return MayBegin(*read); });
  if (due == asked_.end()) return nullptr;
  std::shared_ptr<PendingRead> read = std::move(*due);
  asked_.erase(due);
  return read;
}

std::optional<HungRead> CachedStormStore::HungIn(const Activity& activity) const {
  if (!activity.reads) return std::nullopt;
  const auto since = Now() - activity.went_on;
  if (since <= options_.read_deadline) return std::nullopt;
  return HungRead{activity.file, duration<double>(since).count(), activity.device};
}

std::optional<HungRead> CachedStormStore::NoteHang(Activity& activity) const {
  std::optional<HungRead> hung = HungIn(activity);
  if (hung.has_value() && !std::exchange(activity.told_of_hang, true)) {
    spdlog::error("{}: its storage does not respond; requests for it are refused until it does",
                  hung->file);
  }
  return hung;
}

steady_clock::time_point CachedStormStore::HangsAt(const Activity& activity) const {
  // A thread without a read cannot hang. Waiting callers check again when a read begins.
  if (!activity.reads) return Now() + options_.read_deadline;
  return activity.went_on + options_.read_deadline;
}

std::optional<HungRead> CachedStormStore::Hung() const {
  const Lock lock(mutex_);
  for (const Activity& activity : reading_asked_) {
    if (auto hung = HungIn(activity); hung.has_value()) return hung;
  }
  return HungIn(reading_ahead_);
}

void CachedStormStore::ReadDue(Activity& activity) {
  Lock lock(mutex_);
  while (!ending_) {
    if (const std::shared_ptr<PendingRead> read = TakeDue(); read != nullptr) {
      Read(lock, *read, activity);
      continue;
    }
    // A queued read may begin when the reads in progress have taken long enough.
    std::optional<steady_clock::time_point> next;
    if (!asked_.empty()) {
      for (const Activity& other : reading_asked_) {
        const steady_clock::time_point at = MayReadBesideAt(other);
        if (other.reads && at > Now()) next = std::min(next.value_or(at), at);
      }
    }
    if (next.has_value()) {
      changed_.wait_until(lock, options_.time->LookAgainAt(*next));
    } else {
      changed_.wait(lock);
    }
  }
}

void CachedStormStore::LetOthersEnd(Lock& lock, Activity& activity) {
  activity.reads = false;
  changed_.wait(
      lock, [this] { return ending_ || std::ranges::none_of(reading_asked_, &Activity::reads); });
  activity.reads = true;
  activity.went_on = Now();
  changed_.notify_all();
}

void CachedStormStore::ReadAhead() {
  Lock lock(mutex_);
  while (!ending_) {
    const std::optional<Place> place = NextWanted();
    if (!place.has_value()) {
      changed_.wait(lock);
      continue;
    }
    // The times to be read ahead are probably on the storage that hangs, so reading ahead pauses.
    if (std::ranges::any_of(reading_asked_,
                            [this](const Activity& each) { return HungIn(each).has_value(); })) {
      changed_.wait_until(lock, options_.time->LookAgainAt(Now() + kLookAgain));
      continue;
    }
    const std::shared_ptr<PendingRead> read = Begin(*place, Purpose::kAhead);
    Read(lock, *read, reading_ahead_);
    std::erase(wanted_, place->key);
    const absl::Status& failed = read->result->status();
    if (!failed.ok() && !absl::IsCancelled(failed) && !absl::IsResourceExhausted(failed)) {
      spdlog::warn("reading ahead: {}", std::string(failed.message()));
    }
  }
}

void CachedStormStore::Read(Lock& lock, PendingRead& read, Activity& activity) {
  const TimeKey key = read.place.key;
  const bool is_asked = read.purpose == Purpose::kAsked;
  // The caller may have stopped waiting meanwhile.
  Fields fields = absl::CancelledError("no caller waits for this read any more");
  if (!is_asked || read.waiters > 0) {
    const storm_files::StormFile& file = FileOf(*read.place.storm, read.place.time);
    activity = {
        .reads = true, .file = file.path, .device = file.device, .began = Now(), .went_on = Now()};
    read.activity = &activity;
    changed_.notify_all();  // waiting callers must check from now on whether the read hangs
    fields = ReadFile(lock, read, activity);
    activity.reads = false;
    if (activity.told_of_hang) spdlog::info("{}: its storage responds again", file.path);
  }
  if (is_asked) --asked_reads_;
  // Fields of a time that was removed meanwhile are returned to callers but not cached.
  const bool keep = fields.ok() && PlaceOf(key).has_value();
  if (keep && (is_asked || read.waiters > 0)) {
    cache_.Insert(key, *fields);
  } else if (keep) {
    // The cache must have the only reference, so that it can drop fields that do not fit.
    cache_.InsertAhead(key, *std::exchange(fields, nullptr));
  }
  pending_.erase(key);
  read.result = std::move(fields);
  changed_.notify_all();
}

CachedStormStore::Fields CachedStormStore::ReadFile(Lock& lock, PendingRead& read,
                                                    Activity& activity) {
  const Place& place = read.place;
  const TimeSource source = place.storm->sources[place.time];
  const storm_files::StormFile& file = place.storm->files[source.file];
  if (place.storm->info.times[place.time].deleted) {
    return absl::NotFoundError(absl::StrCat(file.path, ": the file of this time is gone"));
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::optional<storm_files::VerticalGrid> grid,
                               VerticalGridOf(lock, place));
  const std::shared_ptr<const storm_files::RecordReader> reader = file.reader;
  activity.went_on = Now();
  const auto urgency = read.purpose == Purpose::kAsked ? base::MemoryBudget::Urgency::kPatient
                                                       : base::MemoryBudget::Urgency::kAhead;
  lock.unlock();
  const auto read_counted = [&]() -> Fields {
    auto counted = std::make_shared<CountedFields>();
    base::MemoryReservation scratch;
    const std::string what =
        absl::StrCat("storm '", place.storm->info.id, "', a time of ", file.cells.x, " x ",
                     file.cells.y, " x ", file.cells.z, " cells,");
    if (options_.memory != nullptr) {
      base::MemoryBudget& memory = *options_.memory;
      const ReadMemory needs = MemoryFor(file, grid);
      THUNDERHEAD_ASSIGN_OR_RETURN(
          counted->reserved, memory.Reserve(base::MemoryUse::kFields, needs.fields, what, urgency));
      THUNDERHEAD_ASSIGN_OR_RETURN(
          scratch, memory.Reserve(base::MemoryUse::kReading, needs.scratch, what, urgency));
    }
    THUNDERHEAD_RETURN_IF_ERROR(CheckNotReplaced(file, ReplacedRetryAfter()));
    THUNDERHEAD_ASSIGN_OR_RETURN(counted->fields,
                                 reader->Read(source.record, grid, [&](double share) {
                                   return Checkpoint(read, activity, share);
                                 }));
    THUNDERHEAD_RETURN_IF_ERROR(CheckNotReplaced(file, ReplacedRetryAfter()));
    counted->fields.true_north_deg = TrueNorthOf_deg(place.storm->info, place.time);
    if (options_.borders != nullptr) {
      counted->fields.borders =
          options_.borders->MapOf(place.storm->info, place.time, counted->fields.grid);
    }
    if (options_.memory != nullptr) {
      scratch = {};
      THUNDERHEAD_RETURN_IF_ERROR(
          options_.memory->Resize(counted->reserved, counted->fields.Bytes(), what));
    }
    return std::shared_ptr<const volume::HydrometeorFields>(counted, &counted->fields);
  };
  Fields fields = read_counted();
  lock.lock();
  const bool others_read = std::ranges::count(reading_asked_, true, &Activity::reads) > 1;
  if (absl::IsResourceExhausted(fields.status()) && !base::DetailsOf(fields.status()).permanent &&
      read.purpose == Purpose::kAsked && others_read) {
    // Other reads may use the memory that this read needs, so this read waits for their end and is
    // tried again.
    LetOthersEnd(lock, activity);
    lock.unlock();
    fields = read_counted();
    lock.lock();
  }
  if (!fields.ok()) return fields;
  const volume::RegularGrid& used = (*fields)->grid;
  Choose(place, {used.low_corner_m.z, used.spacing_m.z, used.cells.z});
  return fields;
}

// Returns the height grid of the storm's first time that is not deleted, whichever time is read
// first. A time's image therefore does not depend on which times were viewed before. If an earlier
// time is added to the storm later, the grid stays the same. If the grid is not known yet, returns
// nothing if `place` is the first time or the first time cannot be read. Returns UNAVAILABLE if
// another file has replaced the first time's file. The lock is released while the file is read.
absl::StatusOr<std::optional<storm_files::VerticalGrid>> CachedStormStore::VerticalGridOf(
    Lock& lock, const Place& place) {
  const std::optional<ChosenGrid>& known = storms_[place.key.storm].grid;
  if (known.has_value()) return known->grid;
  const CataloguedStorm& storm = *place.storm;
  const std::size_t first_time = FirstTimeThere(storm.info);
  if (place.time == first_time) return std::nullopt;
  const TimeSource first = storm.sources[first_time];
  const storm_files::StormFile& file = storm.files[first.file];
  const std::shared_ptr<const storm_files::RecordReader> reader = file.reader;
  lock.unlock();
  const absl::StatusOr<storm_files::VerticalGrid> chosen = reader->ReadVerticalGrid(first.record);
  const absl::Status replaced = CheckNotReplaced(file, ReplacedRetryAfter());
  lock.lock();
  THUNDERHEAD_RETURN_IF_ERROR(replaced);
  if (!chosen.ok()) {
    spdlog::warn("the first time of {} cannot be read: {}", storm.info.id,
                 std::string(chosen.status().message()));
    return std::nullopt;
  }
  Choose(place, *chosen);
  return *chosen;
}

void CachedStormStore::Choose(const Place& place, const storm_files::VerticalGrid& grid) {
  std::optional<ChosenGrid>& chosen = storms_[place.key.storm].grid;
  // If the storm has been replaced meanwhile, the grid does not belong to the current storm.
  if (chosen.has_value() || !PlaceOf(place.key).has_value()) return;
  const CataloguedStorm& storm = *place.storm;
  const storm_files::StormFile& first = FileOf(storm, FirstTimeThere(storm.info));
  chosen = {grid, first.path, first.version};
}

std::chrono::milliseconds CachedStormStore::ReplacedRetryAfter() const {
  return kToDescribe +
         (options_.live.has_value() ? options_.live->settle : std::chrono::milliseconds(0));
}

absl::Status CachedStormStore::Checkpoint(PendingRead& read, Activity& activity, double share) {
  Lock lock(mutex_);
  if (ending_) return absl::CancelledError("the store of storms has ended");
  if (read.purpose == Purpose::kAhead) {
    const auto unwanted = [&] { return read.waiters == 0 && !IsWanted(read.place.key); };
    activity.reads = false;
    changed_.wait(lock,
                  [&] { return ending_ || read.waiters > 0 || asked_reads_ == 0 || unwanted(); });
    activity.reads = true;
    changed_.notify_all();
    if (ending_ || unwanted()) return absl::CancelledError("read-ahead was cancelled");
  }
  activity.went_on = Now();
  const std::vector<std::shared_ptr<Listener>> listeners = read.listeners;
  lock.unlock();
  for (const auto& listener : listeners) {
    const std::lock_guard calling(listener->mutex);
    if (listener->progress) listener->progress(share);
  }
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
    // A time must not be read ahead if it would evict the time in view. All times are assumed to be
    // equally large.
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

}  // namespace thunderhead::storm_store
