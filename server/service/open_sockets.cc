#include "service/open_sockets.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "absl/strings/str_cat.h"

namespace thunderhead::service {
namespace {

constexpr std::chrono::milliseconds kLookPause{100};

std::string_view AddressOf(std::string_view peer) { return peer.substr(0, peer.rfind(':')); }

}  // namespace

std::optional<std::string> OpenSockets::PeerOf(int socket) {
  sockaddr_storage peer{};
  socklen_t bytes = sizeof(peer);
  if (getpeername(socket, reinterpret_cast<sockaddr*>(&peer), &bytes) != 0) return std::nullopt;
  std::array<char, INET6_ADDRSTRLEN> text{};
  if (peer.ss_family == AF_INET) {
    const auto* const v4 = reinterpret_cast<const sockaddr_in*>(&peer);
    inet_ntop(AF_INET, &v4->sin_addr, text.data(), text.size());
    return absl::StrCat(text.data(), ":", ntohs(v4->sin_port));
  }
  if (peer.ss_family != AF_INET6) return std::nullopt;
  const auto* const v6 = reinterpret_cast<const sockaddr_in6*>(&peer);
  if (IN6_IS_ADDR_V4MAPPED(&v6->sin6_addr)) {
    inet_ntop(AF_INET, &v6->sin6_addr.s6_addr[12], text.data(), text.size());
    return absl::StrCat(text.data(), ":", ntohs(v6->sin6_port));
  }
  inet_ntop(AF_INET6, &v6->sin6_addr, text.data(), text.size());
  return absl::StrCat("[", text.data(), "]:", ntohs(v6->sin6_port));
}

bool OpenSockets::Take(int socket, const std::string& peer, Clock::time_point now) {
  // Its number was another's that is closed.
  peers_.erase(socket);
  if (!HasRoomFor(peer)) ForgetClosed(now);
  if (!HasRoomFor(peer)) return false;
  peers_.emplace(socket, peer);
  return true;
}

bool OpenSockets::HasRoomFor(const std::string& peer) const {
  if (peers_.size() >= most_) return false;
  if (proxies_.Holds(peer)) return true;
  const auto own = std::ranges::count_if(
      peers_, [&](const auto& open) { return AddressOf(open.second) == AddressOf(peer); });
  return static_cast<std::size_t>(own) < most_per_address_;
}

void OpenSockets::ForgetClosed(Clock::time_point now) {
  if (looked_at_.has_value() && now - *looked_at_ < kLookPause) return;
  looked_at_ = now;
  std::erase_if(peers_, [](const auto& open) { return PeerOf(open.first) != open.second; });
}

}  // namespace thunderhead::service
