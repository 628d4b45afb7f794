// The budget of memory that the process may use for its clients' requests, accounted by use. Each
// use is a reservation with an owner, made before the memory is allocated. If the budget is full,
// cached objects are evicted first, beginning with the least recently used. Safe from any thread.
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

// DescriptionOf is for people ("fields of storms"), LabelOf for metrics ("fields").
std::string_view DescriptionOf(MemoryUse use);
std::string_view LabelOf(MemoryUse use);

class MemoryBudget;

// Memory that is accounted for while this object lives. An empty reservation accounts for none.
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
    kAwaited,  // a caller waits for the result: a refusal counts, and is returned at once
    kPatient,  // the same, but the caller can wait until others have freed memory
    kAhead,    // no caller waits for it yet: a refusal does not count
  };

  struct Options {
    std::string name = "memory";  // for messages: "memory", "GPU memory"
    std::string flag = "--memory-budget";
    std::size_t bytes = std::numeric_limits<std::size_t>::max();
    // The part of `bytes` reserved for drawing, so that storm fields leave memory to draw them.
    std::size_t kept_for_drawing = 0;
  };

  // A cache of objects that are not in use at the moment. It is called by the thread that makes a
  // reservation.
  class Cache {
   public:
    virtual std::optional<std::chrono::steady_clock::time_point> OldestUnused() = 0;
    virtual void DropOldestUnused() = 0;

   protected:
    ~Cache() = default;
  };

  // Registers a cache. While this object lives, the budget can evict the cache's objects. The
  // destructor waits for a call in progress.
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
  // Returns a budget that counts but refuses nothing.
  static std::shared_ptr<MemoryBudget> Unlimited();

  // Reserves memory, and evicts cached objects if necessary. Returns RESOURCE_EXHAUSTED, with the
  // current uses of the memory, if that does not free enough. `what` names the purpose ("storm
  // 'anvil'"). The caller must not hold a lock that a cache takes.
  absl::StatusOr<MemoryReservation> Reserve(MemoryUse use, std::size_t bytes, std::string_view what,
                                            Urgency urgency = Urgency::kAwaited);
  // Changes the size of `reservation` to `bytes`. An increase is reserved like in Reserve.
  absl::Status Resize(MemoryReservation& reservation, std::size_t bytes, std::string_view what);

  std::size_t Bytes() const { return options_.bytes; }
  // Returns whether `bytes` more fit into `share` of the budget at the current use. Does not evict
  // anything.
  bool HasRoom(std::size_t bytes, double share = 1.0) const;
  std::size_t Used() const;
  std::size_t Used(MemoryUse use) const;
  // Returns how many awaited reservations have been refused for lack of memory so far. When the
  // number grows, a thread frees what only it can free, and calls Answer. For example, only their
  // own thread may delete GL objects.
  std::uint64_t Refusals() const { return refusals_; }
  void Answer(std::uint64_t refusals);
  // Sets the listener that is called when Refusals has grown, on the thread that lacks memory. An
  // empty function removes the listener.
  void OnPressure(std::function<void()> listener);

 private:
  explicit MemoryBudget(Options options) : options_(std::move(options)) {}

  friend class MemoryReservation;

  std::size_t LimitOf(MemoryUse use) const;
  bool Take(MemoryUse use, std::size_t bytes);
  void GiveBack(MemoryUse use, std::size_t bytes);
  // Returns false if caches cannot free enough memory.
  bool MakeRoomAndTake(MemoryUse use, std::size_t bytes);
  // Reports the refusal. If `patient`, waits for an answer, up to a maximum time.
  void Press(bool patient);
  absl::Status Refusal(MemoryUse use, std::size_t bytes, std::string_view what) const;

  const Options options_;
  mutable std::mutex counting_;
  std::condition_variable answered_changed_;
  std::uint64_t answered_ = 0;
  std::function<void()> on_pressure_;
  std::array<std::size_t, kMemoryUses.size()> used_{};
  std::atomic<std::uint64_t> refusals_{0};
  std::mutex making_room_;  // held while caches are called; locked before the caches' own locks
  std::vector<Cache*> caches_;
};

// Returns whether `refused` says that a request is larger than the whole budget, so that waiting
// does not help.
bool IsTooLargeForMemory(const absl::Status& refused);

// Makes the allocator of the whole process take blocks of 256 KiB and more from the system, and
// return them when they are freed. Otherwise the arena of one thread would keep them, and other
// threads could not use them.
void ShareFreedBlocks();
// Returns memory that the process has freed to the system. Takes a few milliseconds.
void GiveBackFreedMemory();

// Returns "1.5 GiB" or "312 MiB", for example.
std::string InWords(std::size_t bytes);

}  // namespace thunderhead::base
