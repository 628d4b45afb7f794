// Memory accounting of a thread's GL objects. Their memory counts against a budget. It is reserved
// before the object is created, and creation fails if the budget is exhausted. This code does not
// use scenes.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>

#include "base/memory_budget.h"

namespace thunderhead::gl {

// While an object of this class exists, the GL objects that its thread creates count against the
// budget. GL objects created without it are not counted.
class DeviceMemory {
 public:
  // `drop_unused` deletes an object that only this thread holds and with which it does not
  // currently draw. It returns false if there is no such object.
  DeviceMemory(std::shared_ptr<base::MemoryBudget> budget, std::function<bool()> drop_unused);
  ~DeviceMemory();
  DeviceMemory(const DeviceMemory&) = delete;
  DeviceMemory& operator=(const DeviceMemory&) = delete;

  // Reserves memory for an object that this thread is about to create. Throws
  // base::FailedAllocation if there is not enough memory even after unused objects were dropped.
  static base::MemoryReservation Reserve(std::size_t bytes);
  // Reserves memory that drawing needs in addition to its GL objects. It is counted only with
  // software rendering, where that memory and the GL objects are both in main memory. Throws like
  // Reserve.
  static base::MemoryReservation ReserveBeside(std::size_t bytes);

 private:
  base::MemoryReservation Take(std::size_t bytes) const;

  const std::shared_ptr<base::MemoryBudget> budget_;
  const std::function<bool()> drop_unused_;
};

}  // namespace thunderhead::gl
