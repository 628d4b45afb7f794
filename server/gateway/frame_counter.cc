#include "gateway/frame_counter.h"

#include <algorithm>

namespace thunderhead::gateway {
namespace {

constexpr unsigned kControlBit = 0x08;  // bit of the opcode that marks a control frame
constexpr unsigned kOpcodeBits = 0x0f;
constexpr unsigned kClose = 0x08;
constexpr unsigned kMaskBit = 0x80;            // bit of the second byte that marks a masked payload
constexpr std::size_t kMaskedHeaderBytes = 6;  // header bytes of the shortest masked frame
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

void FrameCounter::TakeClosePayload(std::span<const std::byte> bytes) {
  for (std::size_t i = 0; i < bytes.size() && close_code_bytes_left_ > 0; ++i) {
    const std::byte mask = close_mask_[close_mask_.size() - close_code_bytes_left_--];
    close_code_ = close_code_ << 8U | Value(bytes[i] ^ mask);
  }
}

bool FrameCounter::Take(std::span<const std::byte> bytes, base::Allowance::Time now) {
  while (!bytes.empty() && !exceeded_ && !HasForbiddenCode()) {
    if (payload_left_ > 0) {
      const auto skipped =
          static_cast<std::size_t>(std::min<std::uint64_t>(payload_left_, bytes.size()));
      TakeClosePayload(bytes.first(skipped));
      payload_left_ -= skipped;
      bytes = bytes.subspan(skipped);
      continue;
    }
    header_[header_bytes_++] = bytes.front();
    bytes = bytes.subspan(1);
    if (header_bytes_ < HeaderBytes()) continue;
    payload_left_ = PayloadBytes();
    close_code_bytes_left_ = 0;
    if ((Value(header_[0]) & kOpcodeBits) == kClose && header_bytes_ >= kMaskedHeaderBytes) {
      // The mask is the last four bytes of the header. Beast refuses a frame without one.
      std::copy_n(header_.begin() + static_cast<std::ptrdiff_t>(header_bytes_) - 4,
                  close_mask_.size(), close_mask_.begin());
      close_code_bytes_left_ = close_mask_.size();
      close_code_ = 0;
    }
    header_bytes_ = 0;
    const bool carries_nothing = payload_left_ == 0 || (Value(header_[0]) & kControlBit) != 0;
    if (carries_nothing) exceeded_ = allowance_.Take(now).has_value();
  }
  return !exceeded_ && !HasForbiddenCode();
}

}  // namespace thunderhead::gateway
