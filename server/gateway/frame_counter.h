// Parses the WebSocket frames (RFC 6455, 5.2) that a client sends, to limit frames without data and
// to find close codes that no endpoint may send. Beast skips empty fragments and answers pings
// automatically. So a client could occupy the gateway's thread with millions of such frames without
// sending a message. Beast also accepts close codes above 4999, and would send them back.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "base/allowance.h"

namespace thunderhead::gateway {

class FrameCounter {
 public:
  // Maximum number of control frames and empty frames per second, with bursts of twice as many.
  static constexpr int kMostEmptyFramesPerSecond = 100;

  explicit FrameCounter(base::Allowance::Time now) : allowance_(kMostEmptyFramesPerSecond, now) {}

  // Parses the next bytes of the connection. Returns false once the client has sent too many frames
  // without data, or a forbidden close code.
  bool Take(std::span<const std::byte> bytes, base::Allowance::Time now);

  // Returns true once the client has closed with a code above 4999 (RFC 6455, 7.4.2).
  bool HasForbiddenCode() const { return close_code_ > kHighestCloseCode; }

 private:
  static constexpr unsigned kHighestCloseCode = 4999;

  // Returns the size of the current frame's header, as far as the bytes read so far determine it.
  std::size_t HeaderBytes() const;
  std::uint64_t PayloadBytes() const;
  // Takes the bytes of a close frame's payload, which begins with the code.
  void TakeClosePayload(std::span<const std::byte> bytes);

  base::Allowance allowance_;
  std::array<std::byte, 14> header_{};
  std::size_t header_bytes_ = 0;
  std::uint64_t payload_left_ = 0;
  bool exceeded_ = false;
  std::array<std::byte, 2> close_mask_{};
  std::size_t close_code_bytes_left_ = 0;
  unsigned close_code_ = 0;
};

}  // namespace thunderhead::gateway
