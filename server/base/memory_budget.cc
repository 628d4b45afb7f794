#include "base/memory_budget.h"

#include <malloc.h>

#include <algorithm>
#include <map>
#include <numeric>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/error_details.h"
#include "base/status.h"

namespace thunderhead::base {
namespace {

// The retry delay of a refusal. Memory is freed when viewers leave or switch to another storm. They
// usually do this within seconds or not for a long time.
constexpr std::chrono::seconds kMemoryRetryAfter{10};
constexpr char kTooLarge[] = "TOO_LARGE_FOR_MEMORY";

// The longest wait of a kPatient reservation. It is long enough for the drawing thread to finish
// its turn, at whose end it frees unused memory.
constexpr std::chrono::seconds kLongestPatience{2};

std::size_t IndexOf(MemoryUse use) { return static_cast<std::size_t>(use); }

}  // namespace

std::string_view DescriptionOf(MemoryUse use) {
  switch (use) {
    case MemoryUse::kFields:
      return "fields of storms";
    case MemoryUse::kReading:
      return "reading";
    case MemoryUse::kDrawing:
      return "drawing";
    case MemoryUse::kTracing:
      return "tracing";
    case MemoryUse::kPictures:
      return "pictures";
  }
  THUNDERHEAD_CHECK(false, "unknown use of memory");
}

std::string_view LabelOf(MemoryUse use) {
  return use == MemoryUse::kFields ? "fields" : DescriptionOf(use);
}

bool IsTooLargeForMemory(const absl::Status& refused) {
  return DetailsOf(refused).reason == kTooLarge;
}

void ShareFreedBlocks() { mallopt(M_MMAP_THRESHOLD, 1 << 18); }

void GiveBackFreedMemory() { malloc_trim(0); }

std::string InWords(std::size_t bytes) {
  constexpr double kMib = 1 << 20;
  const double mib = static_cast<double>(bytes) / kMib;
  if (mib >= 1024.0) return absl::StrFormat("%.1f GiB", mib / 1024.0);
  if (mib < 10.0) return absl::StrFormat("%.1f MiB", mib);
  return absl::StrFormat("%.0f MiB", mib);
}

MemoryReservation::~MemoryReservation() {
  if (budget_ != nullptr) budget_->GiveBack(use_, bytes_);
}

MemoryBudget::Member::Member(std::shared_ptr<MemoryBudget> budget, Cache* cache)
    : budget_(std::move(budget)), cache_(cache) {
  const std::lock_guard lock(budget_->making_room_);
  budget_->caches_.push_back(cache_);
}

MemoryBudget::Member::~Member() {
  if (budget_ == nullptr) return;
  const std::lock_guard lock(budget_->making_room_);
  std::erase(budget_->caches_, cache_);
}

std::shared_ptr<MemoryBudget> MemoryBudget::Make(Options options) {
  return std::shared_ptr<MemoryBudget>(new MemoryBudget(std::move(options)));
}

std::shared_ptr<MemoryBudget> MemoryBudget::Unlimited() { return Make({}); }

bool MemoryBudget::HasRoom(std::size_t bytes, double share) const {
  const std::size_t used = Used();
  const auto limit = static_cast<double>(options_.bytes) * share;
  return static_cast<double>(used) + static_cast<double>(bytes) <= limit;
}

std::size_t MemoryBudget::Used() const {
  const std::lock_guard lock(counting_);
  return std::accumulate(used_.begin(), used_.end(), std::size_t{0});
}

std::size_t MemoryBudget::Used(MemoryUse use) const {
  const std::lock_guard lock(counting_);
  return used_[IndexOf(use)];
}

std::size_t MemoryBudget::LimitOf(MemoryUse use) const {
  if (use == MemoryUse::kDrawing) return options_.bytes;
  return options_.bytes - std::min(options_.kept_for_drawing, options_.bytes);
}

bool MemoryBudget::Take(MemoryUse use, std::size_t bytes) {
  const std::lock_guard lock(counting_);
  const std::size_t used = std::accumulate(used_.begin(), used_.end(), std::size_t{0});
  // The first kept_for_drawing bytes that drawing uses are in the part that is reserved for
  // drawing. Other uses cannot have that part, so these bytes do not count against them.
  const std::size_t drawing = used_[IndexOf(MemoryUse::kDrawing)];
  const std::size_t counted =
      use == MemoryUse::kDrawing ? used : used - std::min(drawing, options_.kept_for_drawing);
  const std::size_t limit = LimitOf(use);
  if (counted > limit || bytes > limit - counted) return false;
  used_[IndexOf(use)] += bytes;
  return true;
}

void MemoryBudget::GiveBack(MemoryUse use, std::size_t bytes) {
  const std::lock_guard lock(counting_);
  used_[IndexOf(use)] -= bytes;
}

absl::StatusOr<MemoryReservation> MemoryBudget::Reserve(MemoryUse use, std::size_t bytes,
                                                        std::string_view what, Urgency urgency) {
  if (MakeRoomAndTake(use, bytes)) return MemoryReservation(shared_from_this(), use, bytes);
  if (urgency != Urgency::kAhead && bytes <= LimitOf(use)) {
    Press(urgency == Urgency::kPatient);
    if (urgency == Urgency::kPatient && MakeRoomAndTake(use, bytes)) {
      return MemoryReservation(shared_from_this(), use, bytes);
    }
  }
  return Refusal(use, bytes, what);
}

void MemoryBudget::Answer(std::uint64_t refusals) {
  {
    const std::lock_guard lock(counting_);
    answered_ = std::max(answered_, refusals);
  }
  answered_changed_.notify_all();
}

void MemoryBudget::OnPressure(std::function<void()> listener) {
  const std::lock_guard lock(counting_);
  on_pressure_ = std::move(listener);
}

void MemoryBudget::Press(bool patient) {
  const std::uint64_t mine = ++refusals_;
  std::unique_lock lock(counting_);
  if (!on_pressure_) return;
  // The lock is held, so that the listener is not called after it was removed.
  on_pressure_();
  if (!patient) return;
  answered_changed_.wait_for(lock, kLongestPatience, [&] { return answered_ >= mine; });
}

absl::Status MemoryBudget::Resize(MemoryReservation& reservation, std::size_t bytes,
                                  std::string_view what) {
  THUNDERHEAD_CHECK(reservation.budget_.get() == this, "a reservation of another budget");
  if (bytes < reservation.bytes_) {
    GiveBack(reservation.use_, reservation.bytes_ - bytes);
  } else if (const std::size_t more = bytes - reservation.bytes_;
             !MakeRoomAndTake(reservation.use_, more)) {
    Press(false);
    return Refusal(reservation.use_, more, what);
  }
  reservation.bytes_ = bytes;
  return absl::OkStatus();
}

bool MemoryBudget::MakeRoomAndTake(MemoryUse use, std::size_t bytes) {
  if (Take(use, bytes)) return true;
  if (bytes > LimitOf(use)) return false;
  const std::lock_guard lock(making_room_);
  bool dropped = false;
  while (!Take(use, bytes)) {
    Cache* oldest = nullptr;
    std::chrono::steady_clock::time_point since;
    for (Cache* cache : caches_) {
      const auto unused = cache->OldestUnused();
      if (!unused.has_value() || (oldest != nullptr && *unused >= since)) continue;
      oldest = cache;
      since = *unused;
    }
    if (oldest == nullptr) return false;
    oldest->DropOldestUnused();
    dropped = true;
  }
  // Freed memory is returned to the system. Otherwise the allocator would keep blocks of about a
  // megabyte in the arena of the thread that took them, where other threads cannot use them. The
  // process would then grow beyond the budget.
  if (dropped) GiveBackFreedMemory();
  return true;
}

absl::Status MemoryBudget::Refusal(MemoryUse use, std::size_t bytes, std::string_view what) const {
  const std::size_t limit = LimitOf(use);
  std::map<std::string, std::string> metadata{
      {"needed", absl::StrCat(bytes)}, {"maximum", absl::StrCat(limit)}, {"unit", "bytes"}};
  const std::string needs =
      absl::StrCat(std::string(what), " needs ", InWords(bytes), " of ", options_.name);
  if (bytes > limit) {
    return WithDetails(absl::ResourceExhaustedError(absl::StrCat(
                           needs, ", and the server has ", InWords(limit),
                           " in all; request less, or start it with a larger ", options_.flag)),
                       {.reason = kTooLarge, .metadata = std::move(metadata), .permanent = true});
  }
  std::string uses;
  std::size_t total = 0;
  {
    const std::lock_guard lock(counting_);
    for (const MemoryUse other : kMemoryUses) {
      const std::size_t used = used_[IndexOf(other)];
      total += used;
      if (used == 0) continue;
      absl::StrAppend(&uses, uses.empty() ? "" : ", ", InWords(used), " by ",
                      std::string(DescriptionOf(other)));
    }
  }
  metadata["used"] = absl::StrCat(total);
  return WithDetails(absl::ResourceExhaustedError(absl::StrCat(
                         needs, "; ", InWords(total), " of ", InWords(options_.bytes),
                         " are in use: ", uses, "; try again later, when other viewers need less")),
                     {.reason = "MEMORY_BUDGET",
                      .metadata = std::move(metadata),
                      .retry_after = kMemoryRetryAfter});
}

}  // namespace thunderhead::base
