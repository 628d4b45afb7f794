// Memory accounting of a thread's GL objects. Their memory counts in a budget, and is refused
// before it is allocated. This code does not use scenes.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>

#include "base/memory_budget.h"

namespace thunderhead::gl {

// While an object of this class lives, the GL objects that its thread creates count in the budget.
// Without one they are not counted.
class DeviceMemory {
 public:
  // `drop_unused` deletes an object that only this thread keeps and does not currently draw with.
  // It returns false if there is none.
  DeviceMemory(std::shared_ptr<base::MemoryBudget> budget, std::function<bool()> drop_unused);
  ~DeviceMemory();
  DeviceMemory(const DeviceMemory&) = delete;
  DeviceMemory& operator=(const DeviceMemory&) = delete;

  // Reserves memory for an object that this thread is about to create. Throws
  // base::FailedAllocation if there is not enough memory even after unused objects were dropped.
  static base::MemoryReservation Reserve(std::size_t bytes);
  // Reserves memory that drawing needs in addition to its GL objects, if both are in main memory,
  // as with software rendering. On other devices nothing is counted.
  static base::MemoryReservation ReserveBeside(std::size_t bytes);

 private:
  base::MemoryReservation Take(std::size_t bytes) const;

  const std::shared_ptr<base::MemoryBudget> budget_;
  const std::function<bool()> drop_unused_;
};

}  // namespace thunderhead::gl
