// Access rules and their response headers: the Host check against DNS rebinding, cross-origin rules
// and security headers. They are independent of sockets and routes.
#pragma once

#include <boost/beast/http/fields.hpp>
#include <boost/beast/http/message.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace thunderhead::gateway {

// Returns the reason why a proxy in front could interpret the request differently from this server
// (request smuggling), or why its Host is malformed. Returns nothing for an unambiguous request.
// RFC 9112, 6.1 and 6.3.
std::optional<std::string> FindAmbiguity(const boost::beast::http::request_header<>& request);

class HttpPolicy {
 public:
  // Allows the names of the loopback address and `allowed_hosts`. Unless the server listens on a
  // `loopback` address, it also allows numeric addresses and this machine's name. A foreign site
  // cannot use these for itself, as it could use any other name (DNS rebinding).
  HttpPolicy(bool loopback, std::vector<std::string> allowed_hosts,
             std::vector<std::string> allowed_origins);

  bool AllowsHost(std::string_view host) const;
  // Returns true for an origin, other than the page's own, whose pages may call.
  bool AllowsOrigin(std::string_view origin) const;

  // Returns true for a request without an Origin header, from the page's own origin, or from an
  // allowed one. A browser sends a simple POST without a preflight, so each call is checked and not
  // only preflights.
  bool MayCall(std::string_view origin, std::string_view host) const;

  // Returns true for the origin of the page that is served under `host`, the request's Host header.
  bool IsOwnOrigin(std::string_view origin, std::string_view host) const;

  // Adds the headers that every response to a request from `origin` has.
  void Decorate(std::string_view origin, boost::beast::http::fields& response) const;
  // Adds the further headers of a response to a preflight. `asked_headers` are the headers that the
  // browser wants to send.
  void DecoratePreflight(std::string_view asked_headers,
                         boost::beast::http::fields& response) const;

 private:
  bool loopback_;
  std::vector<std::string> allowed_hosts_;
  std::vector<std::string> allowed_origins_;
};

}  // namespace thunderhead::gateway
