// A budget for the memory that the process uses for its clients' requests, counted separately for
// each kind of use. Memory is reserved before it is allocated, and released when the
// MemoryReservation is destroyed. If the budget is full, cached objects are evicted first,
// beginning with the least recently used. Safe from any thread.
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

// DescriptionOf returns a name for messages ("fields of storms"), and LabelOf a label for metrics
// ("fields").
std::string_view DescriptionOf(MemoryUse use);
std::string_view LabelOf(MemoryUse use);

class MemoryBudget;

// A reservation of memory. The memory counts as used while this object lives. An empty reservation
// has a size of 0.
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
    kAwaited,  // a caller waits for the result: a refusal increases Refusals() and is returned at
               // once
    kPatient,  // like kAwaited, but Reserve first waits a short time for other threads to free
               // memory
    kAhead,    // no caller waits for the result: a refusal does not increase Refusals()
  };

  struct Options {
    std::string name = "memory";  // the budget's name in messages, such as "GPU memory"
    std::string flag = "--memory-budget";
    std::size_t bytes = std::numeric_limits<std::size_t>::max();
    // The part of `bytes` that only MemoryUse::kDrawing may use, so that storm fields do not take
    // the memory needed to draw them.
    std::size_t kept_for_drawing = 0;
  };

  // A cache whose unused objects the budget may evict. Its functions are called on the thread that
  // makes a reservation.
  class Cache {
   public:
    virtual std::optional<std::chrono::steady_clock::time_point> OldestUnused() = 0;
    virtual void DropOldestUnused() = 0;

   protected:
    ~Cache() = default;
  };

  // The registration of a cache. While this object lives, the budget can evict objects of the
  // cache. The destructor waits until a running call of the cache has returned.
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
  // Returns a budget that counts reservations but never refuses one.
  static std::shared_ptr<MemoryBudget> Unlimited();

  // Reserves memory, and evicts cached objects if necessary. Returns RESOURCE_EXHAUSTED, with the
  // current uses of the memory, if that does not free enough. `what` names the purpose in the error
  // message ("storm 'anvil'"). The caller must not hold a lock that a registered cache also takes.
  absl::StatusOr<MemoryReservation> Reserve(MemoryUse use, std::size_t bytes, std::string_view what,
                                            Urgency urgency = Urgency::kAwaited);
  // Changes the size of `reservation` to `bytes`. An increase is reserved like in Reserve.
  absl::Status Resize(MemoryReservation& reservation, std::size_t bytes, std::string_view what);

  std::size_t Bytes() const { return options_.bytes; }
  // Returns whether the used memory plus `bytes` is at most `share` times the budget. Does not
  // evict anything.
  bool HasRoom(std::size_t bytes, double share = 1.0) const;
  std::size_t Used() const;
  std::size_t Used(MemoryUse use) const;
  // Returns how many awaited reservations have been refused for lack of memory so far. When the
  // number grows, a thread frees memory that only this thread can free, such as GL objects of its
  // context. It then calls Answer with the number that it has read.
  std::uint64_t Refusals() const { return refusals_; }
  void Answer(std::uint64_t refusals);
  // Sets the listener that is called each time Refusals() grows, on the thread whose reservation
  // was refused. An empty function removes the listener.
  void OnPressure(std::function<void()> listener);

 private:
  explicit MemoryBudget(Options options) : options_(std::move(options)) {}

  friend class MemoryReservation;

  std::size_t LimitOf(MemoryUse use) const;
  bool Take(MemoryUse use, std::size_t bytes);
  void GiveBack(MemoryUse use, std::size_t bytes);
  // Returns false if caches cannot free enough memory.
  bool MakeRoomAndTake(MemoryUse use, std::size_t bytes);
  // Increases Refusals() and calls the listener. If `patient`, it then waits until another thread
  // calls Answer, up to a maximum time.
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

// Returns whether `refused` is the error of Reserve for a request that is larger than the whole
// budget, so that waiting does not help.
bool IsTooLargeForMemory(const absl::Status& refused);

// Makes the allocator of the whole process take blocks of 256 KiB and more from the system, and
// return them when they are freed. Otherwise the allocator's arena of one thread would keep the
// freed blocks, and other threads could not use them.
void ShareFreedBlocks();
// Returns memory that the process has freed to the system. Takes a few milliseconds.
void GiveBackFreedMemory();

// Returns "1.5 GiB" or "312 MiB", for example.
std::string InWords(std::size_t bytes);

}  // namespace thunderhead::base
