// Counts the open connections, in total and per address. Other objects own and close the
// connections; this class checks their descriptors when the maximum seems to be reached. A new
// connection beyond the maximum replaces a connection without a call. Used by one thread only.
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "base/trusted_proxies.h"
#include "rpc_port/connection_calls.h"

namespace thunderhead::rpc_port {

class OpenSockets {
 public:
  using Clock = std::chrono::steady_clock;

  // `most` limits all connections, and `most_per_address` those of one IPv4 address or IPv6 network
  // (/64). Only `most` applies to addresses in `proxies`. `calls` reports which connections have
  // calls. Tests replace `peer_of`.
  OpenSockets(std::size_t most, std::size_t most_per_address, base::TrustedProxies proxies,
              std::shared_ptr<ConnectionCalls> calls,
              std::function<std::optional<std::string>(int)> peer_of = PeerOf)
      : most_(most),
        most_per_address_(most_per_address),
        proxies_(std::move(proxies)),
        calls_(std::move(calls)),
        peer_of_(std::move(peer_of)) {}

  // Returns the remote end of a connected socket, "1.2.3.4:80" or "[::1]:80"; nothing if the socket
  // is not connected.
  static std::optional<std::string> PeerOf(int socket);

  // Counts a new connection. If the maximum is reached (in total, or of the peer's address), shuts
  // down another connection without a call. This connection belongs to the peer's address, or to
  // the address with the most connections if the total is reached. Connections that never had a
  // call are shut down first, then those without a call for longest. Returns false if all of them
  // have calls. Connections that other objects have closed are searched for at most ten times a
  // second.
  bool Take(int socket, const std::string& peer, Clock::time_point now);

  // Returns a peer of the network that sends most, or nothing if none sends much. Counts what
  // arrives within some milliseconds, and what gRPC has not read by then. Addresses in `proxies`
  // are left out.
  std::optional<std::string> WhoSendsMost() const;

  // Resets all connections of this peer's network. What they have sent is dropped if gRPC has not
  // read it yet.
  void AbortNetworkOf(const std::string& peer);

  // Shuts down the connections that have had no call for `unused` or longer.
  void CloseUnused(std::chrono::milliseconds unused, Clock::time_point now);

 private:
  struct Open {
    std::string peer;
    std::string network;
    Clock::time_point since;
  };

  bool HasItsShare(const Open& newcomer) const;
  // Shuts down one connection of that network, or of any network if it is null.
  bool CloseLeastNeeded(const std::string* network, Clock::time_point now);
  void Close(std::map<int, Open>::iterator open);
  void ForgetClosed(Clock::time_point now);
  // Removes a connection. Its call counts are kept if a newer connection has the same peer.
  void Forget(std::map<int, Open>::iterator open);
  bool HasOpen(const std::string& peer) const;

  const std::size_t most_;
  const std::size_t most_per_address_;
  const base::TrustedProxies proxies_;
  const std::shared_ptr<ConnectionCalls> calls_;
  const std::function<std::optional<std::string>(int)> peer_of_;
  std::map<int, Open> open_;  // by file descriptor
  std::optional<Clock::time_point> looked_at_;
};

}  // namespace thunderhead::rpc_port
