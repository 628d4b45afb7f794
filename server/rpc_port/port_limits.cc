#include "rpc_port/port_limits.h"

#include <algorithm>

namespace thunderhead::rpc_port {

std::chrono::milliseconds DeliveryTime(const PortLimits& limits, std::size_t bytes) {
  const auto time = limits.delivery_time +
                    std::chrono::ceil<std::chrono::milliseconds>(std::chrono::duration<double>(
                        static_cast<double>(bytes) / limits.min_bytes_per_second));
  return std::min(time, std::max(limits.delivery_time, limits.max_delivery_time));
}

}  // namespace thunderhead::rpc_port
