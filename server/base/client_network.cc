#include "base/client_network.h"

#include <arpa/inet.h>

#include <cstddef>
#include <cstring>

#include "absl/strings/str_cat.h"

namespace thunderhead::base {
namespace {

constexpr std::size_t kNetworkBytes = 8;
constexpr std::size_t kMappedBytes = 12;  // bytes before the IPv4 address in a mapped IPv6 address

// Returns "1.2.3.4" for "1.2.3.4:80", and "::1" for "[::1]:80".
std::string HostOf(const std::string& peer) {
  const std::size_t bracket = peer.find(']');
  if (!peer.empty() && peer.front() == '[' && bracket != std::string::npos) {
    return peer.substr(1, bracket - 1);
  }
  return peer.substr(0, peer.rfind(':'));
}

}  // namespace

std::string NetworkOf(const std::string& peer) {
  std::string host = HostOf(peer);
  in6_addr address{};
  if (inet_pton(AF_INET6, host.c_str(), &address) != 1) return host;
  char text[INET6_ADDRSTRLEN];
  if (IN6_IS_ADDR_V4MAPPED(&address)) {
    const char* const v4 = inet_ntop(AF_INET, address.s6_addr + kMappedBytes, text, sizeof(text));
    return v4 == nullptr ? host : v4;
  }
  std::memset(address.s6_addr + kNetworkBytes, 0, sizeof(address.s6_addr) - kNetworkBytes);
  if (inet_ntop(AF_INET6, &address, text, sizeof(text)) == nullptr) return host;
  return absl::StrCat(text, "/64");
}

}  // namespace thunderhead::base
