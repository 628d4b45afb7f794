// The proxies that are trusted to report their clients' addresses in X-Forwarded-For. Each proxy
// appends the address from which it received the request. The header is ignored if it comes from
// any other address. This class does not depend on HTTP.
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
  // Trusts no proxy.
  TrustedProxies() = default;
  // Parses addresses and networks: "127.0.0.1", "10.1.0.0/16", "2001:db8::/32". For a text that is
  // neither, returns INVALID_ARGUMENT with the text.
  static absl::StatusOr<TrustedProxies> Parse(const std::vector<std::string>& networks);

  // Returns whether `peer` is a trusted proxy. `peer` is an address with a port, such as
  // "1.2.3.4:80" or "[::1]:80".
  bool Holds(std::string_view peer) const;
  // Returns the address of the client on whose behalf `peer` calls, in the same form as `peer` and
  // with port 0. This is the last address in `forwarded_for`, the value of the header, that is not
  // a trusted proxy, or the first address if all are trusted. Entries before one that is no address
  // are ignored. Returns `peer` if it is not a trusted proxy, or if the last entry is no address.
  std::string ClientOf(const std::string& peer, std::string_view forwarded_for) const;

 private:
  // An IPv6 address. IPv4 addresses are mapped into IPv6.
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
