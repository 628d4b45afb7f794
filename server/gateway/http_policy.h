// Who may ask and what every answer says about it: the Host check against DNS rebinding,
// cross-origin rules and security headers. Knows no socket and no route.
#pragma once

#include <boost/beast/http/fields.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace thunderhead::gateway {

class HttpPolicy {
 public:
  // `loopback` turns the Host check on: only names of this machine's loopback are answered.
  HttpPolicy(bool loopback, std::vector<std::string> allowed_origins);

  bool AllowsHost(std::string_view host) const;
  // True for an origin, other than the page's own, that may call.
  bool AllowsOrigin(std::string_view origin) const;

  // Adds the headers that every answer to a request with `origin` carries.
  void Decorate(std::string_view origin, boost::beast::http::fields& response) const;
  // Adds what the answer to a preflight says beyond that; `asked_headers` is what the browser wants
  // to send.
  void DecoratePreflight(std::string_view asked_headers,
                         boost::beast::http::fields& response) const;

 private:
  bool loopback_;
  std::vector<std::string> allowed_origins_;
};

}  // namespace thunderhead::gateway
