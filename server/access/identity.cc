#include "access/identity.h"

#include <arpa/inet.h>

#include <array>
#include <cstring>
#include <utility>

#include "absl/status/status.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"

namespace thunderhead::access {
namespace {

constexpr std::array kNames = {
    std::pair{Role::kViewer, "viewer"},
    std::pair{Role::kPresenter, "presenter"},
    std::pair{Role::kPipeline, "pipeline"},
    std::pair{Role::kOperator, "operator"},
};

constexpr std::size_t kNetworkBytes = 8;

// "1.2.3.4" of "1.2.3.4:80", "::1" of "[::1]:80".
std::string HostOf(const std::string& peer) {
  const std::size_t bracket = peer.find(']');
  if (!peer.empty() && peer.front() == '[' && bracket != std::string::npos) {
    return peer.substr(1, bracket - 1);
  }
  return peer.substr(0, peer.rfind(':'));
}

}  // namespace

absl::StatusOr<Role> ParseRole(std::string_view text) {
  for (const auto& [role, name] : kNames) {
    if (text == name) return role;
  }
  return absl::InvalidArgumentError(absl::StrCat(
      "'", std::string(text), "' is no role; there are viewer, presenter, pipeline and operator"));
}

const char* NameOf(Role role) {
  for (const auto& [one, name] : kNames) {
    if (one == role) return name;
  }
  return "unknown";
}

std::string NetworkOf(const std::string& peer) {
  std::string host = HostOf(peer);
  in6_addr address{};
  if (inet_pton(AF_INET6, host.c_str(), &address) != 1) return host;
  if (IN6_IS_ADDR_V4MAPPED(&address)) return host.substr(host.rfind(':') + 1);
  std::memset(address.s6_addr + kNetworkBytes, 0, sizeof(address.s6_addr) - kNetworkBytes);
  char text[INET6_ADDRSTRLEN];
  if (inet_ntop(AF_INET6, &address, text, sizeof(text)) == nullptr) return host;
  return absl::StrCat(text, "/64");
}

}  // namespace thunderhead::access
