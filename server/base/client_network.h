// Whom limits of one client count as one, by its address.
#pragma once

#include <string>

namespace thunderhead::base {

// The part of a client's address that stays the same between its connections: an IPv4 address, or
// the first half (/64) of an IPv6 address, of which one client may have them all. An IPv4 address
// that is written as one of IPv6 counts as what it is; a link-local one with its interface is one
// machine's as a whole. `peer` is "1.2.3.4:80" or "[::1]:80".
std::string NetworkOf(const std::string& peer);

}  // namespace thunderhead::base
