// Groups client addresses, so that a limit per client counts all addresses of one network as one.
#pragma once

#include <string>

namespace thunderhead::base {

// Returns the part of a client's address that stays the same between its connections: an IPv4
// address, or the first half (/64) of an IPv6 address. One client can own every address of a /64.
// An IPv4 address that is mapped into IPv6 counts as the IPv4 address. A link-local IPv6 address is
// not shortened, because it belongs to one machine; its interface is included. `peer` is
// "1.2.3.4:80" or "[::1]:80".
std::string NetworkOf(const std::string& peer);

}  // namespace thunderhead::base
