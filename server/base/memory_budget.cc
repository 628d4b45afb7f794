#include "base/memory_budget.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <fstream>

#include "absl/strings/str_format.h"
#include "base/error_details.h"

namespace thunderhead::base {
namespace {

// Time for a session to close or to show something else.
constexpr std::chrono::seconds kRetryAfter{30};

double Mib(std::size_t bytes) { return static_cast<double>(bytes) / (1 << 20); }

}  // namespace

MemoryBudget::Reservation::~Reservation() {
  if (budget_ != nullptr) budget_->Change(bytes_, 0);
}

void MemoryBudget::Reservation::Correct(std::size_t bytes) {
  if (budget_ == nullptr) return;
  budget_->Change(bytes_, bytes);
  bytes_ = bytes;
}

absl::StatusOr<MemoryBudget::Reservation> MemoryBudget::Reserve(std::size_t bytes,
                                                                std::string_view what) {
  std::size_t free_bytes = 0;
  {
    const std::lock_guard lock(mutex_);
    free_bytes = bytes_ - std::min(used_bytes_, bytes_);
    if (bytes <= free_bytes) {
      used_bytes_ += bytes;
      return Reservation(shared_from_this(), bytes);
    }
  }
  const bool ever = bytes <= bytes_;
  ErrorDetails details{.reason = "OUT_OF_MEMORY",
                       .metadata = {{"wanted", absl::StrFormat("%d", bytes)},
                                    {"free", absl::StrFormat("%d", free_bytes)},
                                    {"maximum", absl::StrFormat("%d", bytes_)},
                                    {"unit", "bytes"}}};
  if (ever) details.retry_after = kRetryAfter;
  return WithDetails(
      absl::ResourceExhaustedError(absl::StrFormat(
          "%s needs %.0f MiB of memory; of the %.0f MiB that the server may use %.0f are free: %s",
          std::string(what), Mib(bytes), Mib(bytes_), Mib(free_bytes),
          ever ? "try again later" : "its operator may raise " + flag_)),
      details);
}

std::size_t MemoryBudget::UsedBytes() const {
  const std::lock_guard lock(mutex_);
  return used_bytes_;
}

void MemoryBudget::Change(std::size_t from_bytes, std::size_t to_bytes) {
  const std::lock_guard lock(mutex_);
  used_bytes_ += to_bytes;
  used_bytes_ -= from_bytes;
}

std::size_t DefaultMemoryBudgetBytes() {
  auto bytes = static_cast<std::uint64_t>(::sysconf(_SC_PHYS_PAGES)) *
               static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
  // Containers; absent or "max" without a limit.
  std::uint64_t limit = 0;
  if (std::ifstream file("/sys/fs/cgroup/memory.max"); file >> limit) bytes = std::min(bytes, limit);
  return static_cast<std::size_t>(bytes / 2);
}

}  // namespace thunderhead::base
