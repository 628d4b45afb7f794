// Follows the frames of a WebSocket (RFC 6455, 5.2) in the bytes that its client sends, to limit
// those that carry nothing. Beast skips empty fragments and answers pings by itself, so a client
// could keep the gateway's thread busy with millions of them without ever sending a message.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "base/allowance.h"

namespace thunderhead::gateway {

class FrameCounter {
 public:
  // Control frames and empty frames that a client may send a second; twice as many at once after a
  // rest.
  static constexpr int kMostEmptyFramesPerSecond = 100;

  explicit FrameCounter(base::Allowance::Time now) : allowance_(kMostEmptyFramesPerSecond, now) {}

  // Takes the next bytes of the connection. Returns false once the client has sent too many frames
  // that carry nothing.
  bool Take(std::span<const std::byte> bytes, base::Allowance::Time now);

 private:
  // Bytes of the current frame's header, as far as its first two bytes tell.
  std::size_t HeaderBytes() const;
  std::uint64_t PayloadBytes() const;

  base::Allowance allowance_;
  std::array<std::byte, 14> header_{};
  std::size_t header_bytes_ = 0;
  std::uint64_t payload_left_ = 0;
  bool exceeded_ = false;
};

}  // namespace thunderhead::gateway
