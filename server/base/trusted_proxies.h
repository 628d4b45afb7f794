// The proxies whose word on their clients' addresses is believed: by X-Forwarded-For, to which each
// proxy appends the address that it was asked from. What others send there is ignored. Knows no
// HTTP.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"

namespace thunderhead::base {

class TrustedProxies {
 public:
  // Nobody.
  TrustedProxies() = default;
  // Addresses and networks: "127.0.0.1", "10.1.0.0/16", "2001:db8::/32". INVALID_ARGUMENT names the
  // one that is neither.
  static absl::StatusOr<TrustedProxies> Parse(const std::vector<std::string>& networks);

  // `peer` is "1.2.3.4:80" or "[::1]:80".
  bool Holds(std::string_view peer) const;
  // The client that a call of `peer` is for, in the form of `peer`: the last address of
  // `forwarded_for` that is no trusted proxy's; its port is 0. `peer` itself unless it is trusted
  // and names an address.
  std::string ClientOf(const std::string& peer, std::string_view forwarded_for) const;

 private:
  // Of IPv6; IPv4 as mapped into it.
  using Address = std::array<std::uint8_t, 16>;
  struct Network {
    Address address;
    int bits = 128;
  };

  static bool ParseAddress(std::string_view host, Address* address);
  bool HoldsHost(std::string_view host) const;

  std::vector<Network> networks_;
};

}  // namespace thunderhead::base
