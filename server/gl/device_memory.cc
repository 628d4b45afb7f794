#include "gl/device_memory.h"

#include <epoxy/gl.h>

#include <array>
#include <utility>

#include "base/guarded.h"
#include "base/status.h"
#include "gl/device.h"

namespace thunderhead::gl {
namespace {

thread_local const DeviceMemory* current = nullptr;

constexpr char kWhat[] = "drawing this scene";

std::size_t FromKib(GLint kib) { return static_cast<std::size_t>(kib) << 10U; }

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

DriverMemory DriverMemoryNow() {
  DriverMemory memory;
  if (epoxy_has_gl_extension("GL_NVX_gpu_memory_info")) {
    GLint total_kib = 0;
    GLint free_kib = 0;
    glGetIntegerv(GL_GPU_MEMORY_INFO_TOTAL_AVAILABLE_MEMORY_NVX, &total_kib);
    glGetIntegerv(GL_GPU_MEMORY_INFO_CURRENT_AVAILABLE_VIDMEM_NVX, &free_kib);
    memory = {FromKib(total_kib), FromKib(free_kib)};
  } else if (epoxy_has_gl_extension("GL_ATI_meminfo")) {
    std::array<GLint, 4> kib{};  // free, largest free block, the same of auxiliary memory
    glGetIntegerv(GL_TEXTURE_FREE_MEMORY_ATI, kib.data());
    memory.free_bytes = FromKib(kib[0]);
  }
  return memory;
}

}  // namespace thunderhead::gl
