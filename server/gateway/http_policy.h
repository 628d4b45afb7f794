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

// Returns the reason why a proxy in front of this server could interpret the request differently
// (request smuggling; RFC 9112, 6.1 and 6.3), or why its Host header is malformed. Returns nothing
// for an unambiguous request.
std::optional<std::string> FindAmbiguity(const boost::beast::http::request_header<>& request);

class HttpPolicy {
 public:
  // Allows as hosts the names of the loopback address and `allowed_hosts`. Unless the server
  // listens on a `loopback` address, numeric addresses and this machine's name are allowed too. A
  // foreign site can give any other name the server's address (DNS rebinding), but not these.
  HttpPolicy(bool loopback, std::vector<std::string> allowed_hosts,
             std::vector<std::string> allowed_origins);

  bool AllowsHost(std::string_view host) const;
  // Returns true if the origin is allowed to make calls although it is not the page's own.
  bool AllowsOrigin(std::string_view origin) const;

  // Returns true for a request without an Origin header, from the page's own origin, or from an
  // allowed origin. Each call is checked, and not only preflights, because browsers send a simple
  // POST without a preflight.
  bool MayCall(std::string_view origin, std::string_view host) const;

  // Returns true for the origin of the page that is served under `host`, the request's Host header.
  bool IsOwnOrigin(std::string_view origin, std::string_view host) const;

  // Adds to `response` the headers that every response to a request from `origin` has.
  void Decorate(std::string_view origin, boost::beast::http::fields& response) const;
  // Adds the headers that only a response to a preflight has. `asked_headers` are the headers that
  // the browser wants to send.
  void DecoratePreflight(std::string_view asked_headers,
                         boost::beast::http::fields& response) const;

 private:
  bool loopback_;
  std::vector<std::string> allowed_hosts_;
  std::vector<std::string> allowed_origins_;
};

}  // namespace thunderhead::gateway
