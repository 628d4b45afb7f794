// How many connections are open, and of whom, where others own and close them: their descriptors
// are looked at again when there seem to be too many. Then a newcomer takes the place of one that
// has no call. Used by one thread.
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
#include "service/connection_calls.h"

namespace thunderhead::service {

class OpenSockets {
 public:
  using Clock = std::chrono::steady_clock;

  // Of all, and of one address; of IPv6 of one network (/64). Those of `proxies` may have as many
  // as there may be in all. `calls` tells which connections have calls; `peer_of` is another than
  // PeerOf in tests.
  OpenSockets(std::size_t most, std::size_t most_per_address, base::TrustedProxies proxies,
              std::shared_ptr<ConnectionCalls> calls,
              std::function<std::optional<std::string>(int)> peer_of = PeerOf)
      : most_(most),
        most_per_address_(most_per_address),
        proxies_(std::move(proxies)),
        calls_(std::move(calls)),
        peer_of_(std::move(peer_of)) {}

  // The other end of a connected socket, "1.2.3.4:80" or "[::1]:80"; nothing if it is none.
  static std::optional<std::string> PeerOf(int socket);

  // Counts a connection. If there are as many as there may be, of all or of the peer's address, it
  // shuts another down: of the peer's address, or of the one with most of them, the one that has
  // been without a call for longest, those that never had one first. False if all have calls. Looks
  // for those that others closed ten times a second at most.
  bool Take(int socket, const std::string& peer, Clock::time_point now);

  // Shuts those down that have been without a call for so long.
  void CloseUnused(std::chrono::milliseconds unused, Clock::time_point now);

 private:
  struct Open {
    std::string peer;
    std::string network;
    Clock::time_point since;
  };

  bool HasItsShare(const Open& newcomer) const;
  // Shuts one down, of that network or of any if it is null.
  bool CloseLeastNeeded(const std::string* network, Clock::time_point now);
  void Close(std::map<int, Open>::iterator open);
  void ForgetClosed(Clock::time_point now);
  // Another connection may have the peer by now, and so the use.
  void Forget(std::map<int, Open>::iterator open);
  bool HasOpen(const std::string& peer) const;

  const std::size_t most_;
  const std::size_t most_per_address_;
  const base::TrustedProxies proxies_;
  const std::shared_ptr<ConnectionCalls> calls_;
  const std::function<std::optional<std::string>(int)> peer_of_;
  std::map<int, Open> open_;  // by descriptor
  std::optional<Clock::time_point> looked_at_;
};

}  // namespace thunderhead::service
