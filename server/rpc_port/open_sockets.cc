#include "rpc_port/open_sockets.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <thread>
#include <tuple>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "base/client_network.h"
#include "rpc_port/bytes_received.h"

namespace thunderhead::rpc_port {
namespace {

constexpr std::chrono::milliseconds kLookPause{100};
constexpr std::chrono::milliseconds kMeasurement{10};
// A client with ordinary calls sends less than this within kMeasurement, a flood of calls sends
// more.
constexpr std::uint64_t kMuch_bytes = 4096;

// A connection counts as used until this long after its last call, because some handlers release
// the caller before they respond.
constexpr std::chrono::seconds kJustUsed{10};

// Resets a TCP connection. Unlike shutdown, this also drops the bytes that have arrived and that
// gRPC has not read yet.
void Disconnect(int socket) {
  sockaddr nobody{};
  nobody.sa_family = AF_UNSPEC;
  (void)connect(socket, &nobody, sizeof(nobody));
}

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
  // If the descriptor's number is known, it belonged to a connection that is closed by now.
  if (const auto closed = open_.find(socket); closed != open_.end()) Forget(closed);
  const Open newcomer{peer, base::NetworkOf(peer), now};
  const auto is_full = [&] { return open_.size() >= most_ || HasItsShare(newcomer); };
  if (is_full()) ForgetClosed(now);
  if (is_full()) {
    const std::string* const own = HasItsShare(newcomer) ? &newcomer.network : nullptr;
    if (!CloseLeastNeeded(own, now)) return false;
  }
  // If the same peer is known, it belonged to a connection that is closed by now.
  for (auto open = open_.begin(); open != open_.end();) {
    const auto at = open++;
    if (at->second.peer == peer && peer_of_(at->first) != peer) open_.erase(at);
  }
  if (!HasOpen(peer)) calls_->Forget(peer);
  open_.emplace(socket, newcomer);
  return true;
}

bool OpenSockets::HasItsShare(const Open& newcomer) const {
  if (proxies_.Holds(newcomer.peer)) return false;
  const auto own = std::ranges::count_if(
      open_, [&](const auto& open) { return open.second.network == newcomer.network; });
  return static_cast<std::size_t>(own) >= most_per_address_;
}

bool OpenSockets::CloseLeastNeeded(const std::string* network, Clock::time_point now) {
  struct Candidate {
    std::map<int, Open>::iterator open;
    // Ranks connections that never had a call first, then those without a call for longest.
    std::tuple<bool, Clock::time_point> rank;
  };
  std::vector<Candidate> candidates;
  std::map<std::tuple<bool, std::string>, std::size_t> numbers;
  for (auto open = open_.begin(); open != open_.end(); ++open) {
    if (network != nullptr && open->second.network != *network) continue;
    const std::optional<ConnectionCalls::Use> use = calls_->UseOf(open->second.peer);
    if (use.has_value() && (use->calls > 0 || now - use->since < kJustUsed)) continue;
    candidates.push_back(
        {open, {use.has_value(), use.has_value() ? use->since : open->second.since}});
    ++numbers[{use.has_value(), open->second.network}];
  }
  const auto order = [&](const Candidate& candidate) {
    const auto& [was_used, since] = candidate.rank;
    const std::size_t together = numbers[{was_used, candidate.open->second.network}];
    return std::tuple(was_used, std::numeric_limits<std::size_t>::max() - together, since);
  };
  const auto least = std::ranges::min_element(candidates, {}, order);
  if (least == candidates.end()) return false;
  Close(least->open);
  return true;
}

std::optional<std::string> OpenSockets::WhoSendsMost() const {
  std::map<int, std::uint64_t> before;
  for (const auto& [socket, open] : open_) before[socket] = BytesReceived(socket);
  std::this_thread::sleep_for(kMeasurement);
  std::map<std::string, std::uint64_t> by_network;
  std::optional<std::string> most;
  std::uint64_t most_bytes = kMuch_bytes;
  for (const auto& [socket, open] : open_) {
    if (proxies_.Holds(open.peer) || peer_of_(socket) != open.peer) continue;
    std::uint64_t& bytes = by_network[open.network];
    bytes += BytesReceived(socket) - before[socket] + BytesUnread(socket);
    if (bytes <= most_bytes) continue;
    most_bytes = bytes;
    most = open.peer;
  }
  return most;
}

void OpenSockets::AbortNetworkOf(const std::string& peer) {
  const std::string network = base::NetworkOf(peer);
  for (auto open = open_.begin(); open != open_.end();) {
    const auto at = open++;
    if (at->second.network != network) continue;
    if (peer_of_(at->first) == at->second.peer) Disconnect(at->first);
    Forget(at);
  }
}

void OpenSockets::CloseUnused(std::chrono::milliseconds unused, Clock::time_point now) {
  ForgetClosed(now);
  for (auto open = open_.begin(); open != open_.end();) {
    const auto at = open++;
    const std::optional<ConnectionCalls::Use> use = calls_->UseOf(at->second.peer);
    if (use.has_value() && use->calls > 0) continue;
    if (now - (use.has_value() ? use->since : at->second.since) >= unused) Close(at);
  }
}

void OpenSockets::Close(std::map<int, Open>::iterator open) {
  const auto& [socket, connection] = *open;
  // After the shutdown, gRPC sees the end of the connection and closes it. gRPC owns the descriptor
  // and may just have closed it, so the peer is compared first.
  if (peer_of_(socket) == connection.peer) shutdown(socket, SHUT_RDWR);
  Forget(open);
}

void OpenSockets::ForgetClosed(Clock::time_point now) {
  if (looked_at_.has_value() && now - *looked_at_ < kLookPause) return;
  looked_at_ = now;
  for (auto open = open_.begin(); open != open_.end();) {
    const auto at = open++;
    if (peer_of_(at->first) != at->second.peer) Forget(at);
  }
}

void OpenSockets::Forget(std::map<int, Open>::iterator open) {
  const std::string peer = std::move(open->second.peer);
  open_.erase(open);
  if (!HasOpen(peer)) calls_->Forget(peer);
}

bool OpenSockets::HasOpen(const std::string& peer) const {
  return std::ranges::any_of(open_, [&](const auto& open) { return open.second.peer == peer; });
}

}  // namespace thunderhead::rpc_port
