// The budget of memory that the process may use for its clients' requests, accounted by use. Each
// use is a reservation that somebody owns, made before the memory is allocated; where there is no
// room, cached objects are dropped first, beginning with the least recently used. Safe from any
// thread.
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace thunderhead::base {

enum class MemoryUse { kFields, kReading, kDrawing, kTracing, kPictures };
inline constexpr std::array kMemoryUses{MemoryUse::kFields, MemoryUse::kReading,
                                        MemoryUse::kDrawing, MemoryUse::kTracing,
                                        MemoryUse::kPictures};

// For people: "fields of storms". For metrics: "fields".
std::string_view DescriptionOf(MemoryUse use);
std::string_view LabelOf(MemoryUse use);

class MemoryBudget;

// Memory that is accounted for while this object lives; none if it is empty.
class MemoryReservation {
 public:
  MemoryReservation() = default;
  MemoryReservation(MemoryReservation&& other) noexcept { Swap(other); }
  MemoryReservation& operator=(MemoryReservation&& other) noexcept {
    MemoryReservation(std::move(other)).Swap(*this);
    return *this;
  }
  ~MemoryReservation();

  std::size_t Bytes() const { return bytes_; }

 private:
  friend class MemoryBudget;
  MemoryReservation(std::shared_ptr<MemoryBudget> budget, MemoryUse use, std::size_t bytes)
      : budget_(std::move(budget)), use_(use), bytes_(bytes) {}
  void Swap(MemoryReservation& other) noexcept {
    std::swap(budget_, other.budget_);
    std::swap(use_, other.use_);
    std::swap(bytes_, other.bytes_);
  }

  std::shared_ptr<MemoryBudget> budget_;
  MemoryUse use_ = MemoryUse::kFields;
  std::size_t bytes_ = 0;
};

class MemoryBudget : public std::enable_shared_from_this<MemoryBudget> {
 public:
  enum class Urgency {
    kAwaited,  // somebody waits for the result: a refusal counts, and is returned at once
    kPatient,  // the same, but the caller can wait until others have given memory back
    kAhead,    // nobody waits for it yet: a refusal does not count
  };

  struct Options {
    std::string name = "memory";  // for messages: "memory", "GPU memory"
    std::string flag = "--memory-budget";
    std::size_t bytes = std::numeric_limits<std::size_t>::max();
    // The part of `bytes` reserved for drawing, so that fields leave room to show them.
    std::size_t kept_for_drawing = 0;
  };

  // A cache of objects that nobody uses at the moment. Called by whichever thread makes a
  // reservation.
  class Cache {
   public:
    virtual std::optional<std::chrono::steady_clock::time_point> OldestUnused() = 0;
    virtual void DropOldestUnused() = 0;

   protected:
    ~Cache() = default;
  };

  // Registers a cache: while this object lives, the cache is asked for room. Its destructor waits
  // for a call under way.
  class Member {
   public:
    Member() = default;
    Member(std::shared_ptr<MemoryBudget> budget, Cache* cache);
    Member(Member&& other) noexcept {
      std::swap(budget_, other.budget_), std::swap(cache_, other.cache_);
    }
    Member& operator=(Member&&) = delete;
    ~Member();

   private:
    std::shared_ptr<MemoryBudget> budget_;
    Cache* cache_ = nullptr;
  };

  static std::shared_ptr<MemoryBudget> Make(Options options);
  // Refuses nothing, but counts.
  static std::shared_ptr<MemoryBudget> Unlimited();

  // RESOURCE_EXHAUSTED, with what the memory is used for, if it is more than caches can make room
  // for; `what` says what it is for ("storm 'anvil'"). The caller must hold no lock that a cache
  // takes.
  absl::StatusOr<MemoryReservation> Reserve(MemoryUse use, std::size_t bytes, std::string_view what,
                                            Urgency urgency = Urgency::kAwaited);
  // Changes the size of `reservation` to `bytes`; for the difference as Reserve.
  absl::Status Resize(MemoryReservation& reservation, std::size_t bytes, std::string_view what);

  std::size_t Bytes() const { return options_.bytes; }
  // True if `bytes` more fit into `share` of the budget as it is filled now; no cache gives memory
  // back for it.
  bool HasRoom(std::size_t bytes, double share = 1.0) const;
  std::size_t Used() const;
  std::size_t Used(MemoryUse use) const;
  // Awaited reservations for which there was no room so far. A thread that sees it grow gives back
  // what only it can (GL objects, which only their own thread may delete), and calls Answer.
  std::uint64_t Refusals() const { return refusals_; }
  void Answer(std::uint64_t refusals);
  // Called when Refusals has grown, on the thread that has no room; empty for nobody.
  void OnPressure(std::function<void()> listener);

 private:
  explicit MemoryBudget(Options options) : options_(std::move(options)) {}

  friend class MemoryReservation;

  std::size_t LimitOf(MemoryUse use) const;
  bool Take(MemoryUse use, std::size_t bytes);
  void GiveBack(MemoryUse use, std::size_t bytes);
  // False if caches cannot make room for it.
  bool MakeRoomAndTake(MemoryUse use, std::size_t bytes);
  // Tells of the refusal; `patient` waits for an answer, but not for ever.
  void Press(bool patient);
  absl::Status Refusal(MemoryUse use, std::size_t bytes, std::string_view what) const;

  const Options options_;
  mutable std::mutex counting_;
  std::condition_variable answered_changed_;
  std::uint64_t answered_ = 0;
  std::function<void()> on_pressure_;
  std::array<std::size_t, kMemoryUses.size()> used_{};
  std::atomic<std::uint64_t> refusals_{0};
  std::mutex making_room_;  // held while caches are called; before their own locks
  std::vector<Cache*> caches_;
};

// True if `refused` says that a request is larger than the whole budget, so that waiting is of no
// use.
bool IsTooLargeForMemory(const absl::Status& refused);

// Makes the allocator of the whole process take blocks of 256 KiB and more from the system, and
// return them when freed: kept in the arena of one thread, they would be of no use to another.
void ShareFreedBlocks();
// Returns what the process has freed to the system; takes some milliseconds.
void GiveBackFreedMemory();

// "1.5 GiB", "312 MiB".
std::string InWords(std::size_t bytes);

}  // namespace thunderhead::base
