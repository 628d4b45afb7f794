#include "base/trusted_proxies.h"

#include <arpa/inet.h>

#include <algorithm>
#include <cstring>

#include "absl/status/status.h"
#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"

namespace thunderhead::base {
namespace {

constexpr int kMappedBits = 96;  // bits before the IPv4 address in a mapped IPv6 address

// Returns "1.2.3.4" for "1.2.3.4:80" and "1.2.3.4", and "::1" for "[::1]:80" and "::1".
std::string_view HostOf(std::string_view address) {
  if (!address.empty() && address.front() == '[') {
    return address.substr(1, std::min(address.find(']'), address.size()) - 1);
  }
  const std::size_t colon = address.find(':');
  const bool has_port = colon != std::string_view::npos && colon == address.rfind(':');
  return has_port ? address.substr(0, colon) : address;
}

std::string_view Trimmed(std::string_view text) {
  while (!text.empty() && absl::ascii_isspace(static_cast<unsigned char>(text.front()))) {
    text.remove_prefix(1);
  }
  while (!text.empty() && absl::ascii_isspace(static_cast<unsigned char>(text.back()))) {
    text.remove_suffix(1);
  }
  return text;
}

}  // namespace

bool TrustedProxies::ParseAddress(std::string_view host, Address* address) {
  const std::string text(host);
  if (inet_pton(AF_INET6, text.c_str(), address->data()) == 1) return true;
  *address = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xff};
  return inet_pton(AF_INET, text.c_str(), address->data() + kMappedBits / 8) == 1;
}

absl::StatusOr<TrustedProxies> TrustedProxies::Parse(const std::vector<std::string>& networks) {
  TrustedProxies proxies;
  for (const std::string& text : networks) {
    const std::size_t slash = text.find('/');
    const std::string host = text.substr(0, slash);
    Network network;
    const bool is_v4 = host.find(':') == std::string::npos;
    const int most = is_v4 ? 32 : 128;
    int bits = most;
    const bool has_bits =
        slash == std::string::npos || absl::SimpleAtoi(text.substr(slash + 1), &bits);
    if (!ParseAddress(host, &network.address) || !has_bits || bits < 0 || bits > most) {
      return absl::InvalidArgumentError(absl::StrCat(
          "'", text, "' is neither an address nor a network, such as 127.0.0.1 or 10.1.0.0/16"));
    }
    network.bits = is_v4 ? kMappedBits + bits : bits;
    proxies.networks_.push_back(network);
  }
  return proxies;
}

bool TrustedProxies::HoldsHost(std::string_view host) const {
  Address address{};
  if (networks_.empty() || !ParseAddress(host, &address)) return false;
  return std::ranges::any_of(networks_, [&](const Network& network) {
    const auto whole = static_cast<std::size_t>(network.bits / 8);
    if (std::memcmp(address.data(), network.address.data(), whole) != 0) return false;
    const int rest = network.bits % 8;
    if (rest == 0) return true;
    return (address[whole] ^ network.address[whole]) >> (8 - rest) == 0;
  });
}

bool TrustedProxies::Holds(std::string_view peer) const { return HoldsHost(HostOf(peer)); }

std::string TrustedProxies::ClientOf(const std::string& peer,
                                     std::string_view forwarded_for) const {
  if (!Holds(peer)) return peer;
  std::string client = peer;
  while (!forwarded_for.empty()) {
    const std::size_t comma = forwarded_for.rfind(',');
    const std::size_t begin = comma == std::string_view::npos ? 0 : comma + 1;
    const std::string_view host = HostOf(Trimmed(forwarded_for.substr(begin)));
    Address address{};
    // Trusted proxies append addresses. An entry that is no address, and all entries before it, are
    // therefore the client's own claims.
    if (!ParseAddress(host, &address)) break;
    const bool is_v6 = host.find(':') != std::string_view::npos;
    client =
        is_v6 ? absl::StrCat("[", std::string(host), "]:0") : absl::StrCat(std::string(host), ":0");
    if (!HoldsHost(host)) break;
    forwarded_for = forwarded_for.substr(0, comma == std::string_view::npos ? 0 : comma);
  }
  return client;
}

}  // namespace thunderhead::base
