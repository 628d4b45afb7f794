// Access rules and their response headers: the Host check against DNS rebinding, cross-origin rules
// and security headers. Knows no socket and no route.
#pragma once

#include <boost/beast/http/fields.hpp>
#include <boost/beast/http/message.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace thunderhead::gateway {

// Says why a proxy in front could understand the request otherwise than this server (request
// smuggling), or why its Host is malformed; nothing if it is plain. RFC 9112, 6.1 and 6.3.
std::optional<std::string> FindAmbiguity(const boost::beast::http::request_header<>& request);

class HttpPolicy {
 public:
  // Allowed are the loopback address' own names, `allowed_hosts`, and, unless the server listens on
  // a `loopback` address, other addresses in digits and this machine's name: none of these can a
  // foreign site take for itself, as it could any other name (DNS rebinding).
  HttpPolicy(bool loopback, std::vector<std::string> allowed_hosts,
             std::vector<std::string> allowed_origins);

  bool AllowsHost(std::string_view host) const;
  // True for an origin, other than the page's own, whose pages may call.
  bool AllowsOrigin(std::string_view origin) const;

  // True for a request without an Origin header, from the page's own origin, or from an allowed
  // one. A browser sends a simple POST without asking before, so each call is checked and not the
  // preflight alone.
  bool MayCall(std::string_view origin, std::string_view host) const;

  // True for the origin of the page that is served under `host`, the request's Host header.
  bool IsOwnOrigin(std::string_view origin, std::string_view host) const;

  // Adds the headers of every response to a request from `origin`.
  void Decorate(std::string_view origin, boost::beast::http::fields& response) const;
  // Adds the further headers of the response to a preflight; `asked_headers` are those that the
  // browser wants to send.
  void DecoratePreflight(std::string_view asked_headers,
                         boost::beast::http::fields& response) const;

 private:
  bool loopback_;
  std::vector<std::string> allowed_hosts_;
  std::vector<std::string> allowed_origins_;
};

}  // namespace thunderhead::gateway
