// How many connections are open, and of whom, where others own and close them: their descriptors
// are looked at again when there seem to be too many. Used by one thread.
#pragma once

#include <chrono>
#include <cstddef>
#include <map>
#include <optional>
#include <string>

#include "base/trusted_proxies.h"

namespace thunderhead::service {

class OpenSockets {
 public:
  using Clock = std::chrono::steady_clock;

  // Those of `proxies` may have as many as there may be in all.
  OpenSockets(std::size_t most, std::size_t most_per_address, base::TrustedProxies proxies)
      : most_(most), most_per_address_(most_per_address), proxies_(std::move(proxies)) {}

  // The other end of a connected socket, "1.2.3.4:80" or "[::1]:80"; nothing if it is none.
  static std::optional<std::string> PeerOf(int socket);

  // False if there are as many as there may be, of all or of the peer's address; else counts it.
  // Looks at them again ten times a second at most.
  bool Take(int socket, const std::string& peer, Clock::time_point now = Clock::now());

 private:
  bool HasRoomFor(const std::string& peer) const;
  void ForgetClosed(Clock::time_point now);

  const std::size_t most_;
  const std::size_t most_per_address_;
  const base::TrustedProxies proxies_;
  std::map<int, std::string> peers_;  // by descriptor
  std::optional<Clock::time_point> looked_at_;
};

}  // namespace thunderhead::service
