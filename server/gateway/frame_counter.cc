#include "gateway/frame_counter.h"

#include <algorithm>

namespace thunderhead::gateway {
namespace {

constexpr unsigned kControlBit = 0x08;  // bit of the opcode that marks a control frame
constexpr unsigned kMaskBit = 0x80;     // bit of the second byte that marks a masked payload
constexpr unsigned kLengthBits = 0x7f;
constexpr unsigned kTwoByteLength = 126;
constexpr unsigned kEightByteLength = 127;

unsigned Value(std::byte byte) { return std::to_integer<unsigned>(byte); }

}  // namespace

std::size_t FrameCounter::HeaderBytes() const {
  constexpr std::size_t kFixedBytes = 2;
  if (header_bytes_ < kFixedBytes) return kFixedBytes;
  const unsigned length = Value(header_[1]) & kLengthBits;
  const std::size_t length_bytes = length == kTwoByteLength     ? 2
                                   : length == kEightByteLength ? 8
                                                                : 0;
  const std::size_t mask_bytes = (Value(header_[1]) & kMaskBit) != 0 ? 4 : 0;
  return kFixedBytes + length_bytes + mask_bytes;
}

std::uint64_t FrameCounter::PayloadBytes() const {
  const unsigned length = Value(header_[1]) & kLengthBits;
  const std::size_t bytes = length == kTwoByteLength ? 2 : length == kEightByteLength ? 8 : 0;
  if (bytes == 0) return length;
  std::uint64_t long_length = 0;
  for (std::size_t i = 0; i < bytes; ++i) long_length = long_length << 8U | Value(header_[2 + i]);
  return long_length;
}

bool FrameCounter::Take(std::span<const std::byte> bytes, base::Allowance::Time now) {
  while (!bytes.empty() && !exceeded_) {
    if (payload_left_ > 0) {
      const auto skipped =
          static_cast<std::size_t>(std::min<std::uint64_t>(payload_left_, bytes.size()));
      payload_left_ -= skipped;
      bytes = bytes.subspan(skipped);
      continue;
    }
    header_[header_bytes_++] = bytes.front();
    bytes = bytes.subspan(1);
    if (header_bytes_ < HeaderBytes()) continue;
    payload_left_ = PayloadBytes();
    header_bytes_ = 0;
    const bool carries_nothing = payload_left_ == 0 || (Value(header_[0]) & kControlBit) != 0;
    if (carries_nothing) exceeded_ = allowance_.Take(now).has_value();
  }
  return !exceeded_;
}

}  // namespace thunderhead::gateway
