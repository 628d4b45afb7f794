#include "rpc_port/port_limits.h"

namespace thunderhead::rpc_port {

std::chrono::milliseconds DeliveryTime(const PortLimits& limits, std::size_t bytes) {
  return limits.delivery_time +
         std::chrono::ceil<std::chrono::milliseconds>(std::chrono::duration<double>(
             static_cast<double>(bytes) / limits.min_bytes_per_second));
}

}  // namespace thunderhead::rpc_port
