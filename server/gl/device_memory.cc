#include "gl/device_memory.h"

#include <utility>

#include "base/guarded.h"
#include "base/status.h"
#include "gl/device.h"

namespace thunderhead::gl {
namespace {

thread_local const DeviceMemory* current = nullptr;

constexpr char kWhat[] = "drawing this scene";

}  // namespace

DeviceMemory::DeviceMemory(std::shared_ptr<base::MemoryBudget> budget,
                           std::function<bool()> drop_unused)
    : budget_(std::move(budget)), drop_unused_(std::move(drop_unused)) {
  THUNDERHEAD_CHECK(current == nullptr, "a thread has one context");
  current = this;
}

DeviceMemory::~DeviceMemory() { current = nullptr; }

base::MemoryReservation DeviceMemory::Reserve(std::size_t bytes) {
  return current == nullptr ? base::MemoryReservation() : current->Take(bytes);
}

base::MemoryReservation DeviceMemory::ReserveBeside(std::size_t bytes) {
  return current != nullptr && DrawsInSoftware() ? current->Take(bytes) : base::MemoryReservation();
}

base::MemoryReservation DeviceMemory::Take(std::size_t bytes) const {
  while (true) {
    auto reserved = budget_->Reserve(base::MemoryUse::kDrawing, bytes, kWhat);
    if (reserved.ok()) return *std::move(reserved);
    if (!drop_unused_()) throw base::FailedAllocation(reserved.status());
  }
}

}  // namespace thunderhead::gl
