// Turns a fuzzer's input into the bytes that a client sends after the upgrade to a WebSocket.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>

namespace thunderhead::fuzz {

// Returns frames built from the input. Each begins with its opcode and a size, and is masked
// correctly.
inline std::string Framed(const std::uint8_t* data, std::size_t size) {
  std::string frames;
  std::size_t at = 0;
  while (at + 2 <= size) {
    const std::uint8_t head = data[at];
    const std::size_t length = std::min<std::size_t>(data[at + 1] % 126, size - at - 2);
    frames.push_back(static_cast<char>(head));
    frames.push_back(static_cast<char>(0x80 | length));
    const char mask[4] = {1, 2, 3, 4};
    frames.append(mask, 4);
    for (std::size_t i = 0; i < length; ++i) {
      frames.push_back(static_cast<char>(data[at + 2 + i] ^ mask[i % 4]));
    }
    at += 2 + length;
  }
  return frames;
}

// Returns frames built from all bytes after the first, if the first byte is even. Otherwise returns
// these bytes unchanged, as frames that the fuzzer has made and masked itself.
inline std::string WebSocketBytes(const std::uint8_t* data, std::size_t size) {
  if (data[0] % 2 == 0) return Framed(data + 1, size - 1);
  return {reinterpret_cast<const char*>(data + 1), size - 1};
}

}  // namespace thunderhead::fuzz
