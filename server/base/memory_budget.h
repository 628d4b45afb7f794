// A bound on what many hold in memory together: whoever is about to take much asks first, and is
// refused by name. Safe from any thread.
#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>

#include "absl/status/statusor.h"

namespace thunderhead::base {

class MemoryBudget : public std::enable_shared_from_this<MemoryBudget> {
 public:
  // Bytes that are held; given back when it is destroyed.
  class Reservation {
   public:
    Reservation() = default;
    Reservation(Reservation&& other) noexcept
        : budget_(std::move(other.budget_)), bytes_(std::exchange(other.bytes_, 0)) {}
    Reservation& operator=(Reservation&& other) noexcept {
      std::swap(budget_, other.budget_);
      std::swap(bytes_, other.bytes_);
      return *this;
    }
    ~Reservation();

    std::size_t Bytes() const { return bytes_; }
    // What is held has turned out to be so large, be it more than there is.
    void Correct(std::size_t bytes);

   private:
    friend class MemoryBudget;
    Reservation(std::shared_ptr<MemoryBudget> budget, std::size_t bytes)
        : budget_(std::move(budget)), bytes_(bytes) {}

    std::shared_ptr<MemoryBudget> budget_;
    std::size_t bytes_ = 0;
  };

  // `flag` is what the operator raises it by, for messages.
  MemoryBudget(std::size_t bytes, std::string flag) : bytes_(bytes), flag_(std::move(flag)) {}

  // RESOURCE_EXHAUSTED, with when to try again, if so much is not free; `what` it is for.
  absl::StatusOr<Reservation> Reserve(std::size_t bytes, std::string_view what);

  std::size_t Bytes() const { return bytes_; }
  std::size_t UsedBytes() const;

 private:
  void Change(std::size_t from_bytes, std::size_t to_bytes);

  const std::size_t bytes_;
  const std::string flag_;
  mutable std::mutex mutex_;
  std::size_t used_bytes_ = 0;
};

// Half of this machine's memory, or of what this process may use of it.
std::size_t DefaultMemoryBudgetBytes();

}  // namespace thunderhead::base
