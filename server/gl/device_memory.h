// The memory of a thread's GL objects: counted in a budget, and refused before it is allocated.
// Knows no scene.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>

#include "base/memory_budget.h"

namespace thunderhead::gl {

// While it lives, the GL objects that its thread makes are counted in the budget. Without one they
// are not counted.
class DeviceMemory {
 public:
  // `drop_unused` deletes something that only this thread keeps and does not draw with now; false
  // if there is nothing.
  DeviceMemory(std::shared_ptr<base::MemoryBudget> budget, std::function<bool()> drop_unused);
  ~DeviceMemory();
  DeviceMemory(const DeviceMemory&) = delete;
  DeviceMemory& operator=(const DeviceMemory&) = delete;

  // For an object that this thread is about to make. Throws base::FailedAllocation if there is no
  // room, also after what is unused has gone.
  static base::MemoryReservation Reserve(std::size_t bytes);
  // The same for what drawing keeps beside its GL objects, where both lie in one memory: where
  // processors draw. Elsewhere nothing is counted.
  static base::MemoryReservation ReserveBeside(std::size_t bytes);

 private:
  base::MemoryReservation Take(std::size_t bytes) const;

  const std::shared_ptr<base::MemoryBudget> budget_;
  const std::function<bool()> drop_unused_;
};

}  // namespace thunderhead::gl
