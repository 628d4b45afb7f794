#include "app/address.h"

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"

namespace thunderhead::app {

absl::StatusOr<Address> ParseAddress(const std::string& flag, const std::string& text) {
  const std::size_t colon = text.rfind(':');
  std::uint32_t port = 0;
  if (colon == std::string::npos || colon == 0 ||
      !absl::SimpleAtoi(text.substr(colon + 1), &port) || port > 65535) {
    return absl::InvalidArgumentError(
        absl::StrCat(flag, " is '", text, "'; it must be HOST:PORT, for example 127.0.0.1:8080"));
  }
  Address address{text.substr(0, colon), static_cast<std::uint16_t>(port)};
  if (address.host == "localhost") address.host = "127.0.0.1";
  if (address.host.size() > 2 && address.host.front() == '[' && address.host.back() == ']') {
    address.host = address.host.substr(1, address.host.size() - 2);
  }
  return address;
}

std::string ToString(const Address& address) {
  const bool is_ipv6 = address.host.find(':') != std::string::npos;
  return absl::StrCat(is_ipv6 ? "[" : "", address.host, is_ipv6 ? "]" : "", ":", address.port);
}

}  // namespace thunderhead::app
