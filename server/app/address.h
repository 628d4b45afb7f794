// Parses and prints HOST:PORT.
#pragma once

#include <cstdint>
#include <string>

#include "absl/status/statusor.h"

namespace thunderhead::app {

struct Address {
  std::string host;  // "localhost" becomes 127.0.0.1; an IPv6 address has no brackets
  std::uint16_t port = 0;
};

// Parses HOST:PORT. INVALID_ARGUMENT names `flag` and the expected format.
absl::StatusOr<Address> ParseAddress(const std::string& flag, const std::string& text);

// Returns HOST:PORT, with brackets around an IPv6 address.
std::string ToString(const Address& address);

}  // namespace thunderhead::app
