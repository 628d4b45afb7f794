#include "gateway/http_policy.h"

#include <algorithm>
#include <boost/asio/ip/address.hpp>
#include <boost/asio/ip/host_name.hpp>
#include <boost/beast/http/field.hpp>
#include <string>
#include <utility>

#include "absl/strings/ascii.h"
#include "gateway/text_view.h"

namespace thunderhead::gateway {
namespace {

namespace http = boost::beast::http;

// Pictures are blobs, decoding may run in a worker created from a blob, and sliders have inline
// styles.
constexpr char kContentSecurityPolicy[] =
    "default-src 'self'; img-src 'self' blob: data:; worker-src 'self' blob:; "
    "style-src 'self' 'unsafe-inline'; object-src 'none'; base-uri 'self'; frame-ancestors 'self'";

// "localhost" of "LocalHost:8080", "[::1]" of "[::1]:8080".
std::string WithoutPort(std::string_view host) {
  const size_t bracket = host.find(']');
  const size_t colon = host.find(':', bracket == std::string_view::npos ? 0 : bracket);
  return absl::AsciiStrToLower(std::string(host.substr(0, colon)));
}

// True for "192.0.2.7" and "[2001:db8::7]".
bool IsAddress(const std::string& name) {
  const bool bracketed = name.size() > 2 && name.front() == '[' && name.back() == ']';
  boost::system::error_code error;
  const auto address =
      boost::asio::ip::make_address(bracketed ? name.substr(1, name.size() - 2) : name, error);
  return !error && address.is_v6() == bracketed;
}

}  // namespace

HttpPolicy::HttpPolicy(bool loopback, std::vector<std::string> allowed_hosts,
                       std::vector<std::string> allowed_origins)
    : loopback_(loopback),
      allowed_hosts_(std::move(allowed_hosts)),
      allowed_origins_(std::move(allowed_origins)) {
  for (std::string& host : allowed_hosts_) absl::AsciiStrToLower(&host);
  boost::system::error_code error;
  const std::string own = boost::asio::ip::host_name(error);
  if (!loopback_ && !error) allowed_hosts_.push_back(absl::AsciiStrToLower(own));
}

bool HttpPolicy::AllowsHost(std::string_view host) const {
  const std::string name = WithoutPort(host);
  if (name == "localhost" || name == "127.0.0.1" || name == "[::1]") return true;
  return std::ranges::find(allowed_hosts_, name) != allowed_hosts_.end() ||
         (!loopback_ && IsAddress(name));
}

bool HttpPolicy::AllowsOrigin(std::string_view origin) const {
  return std::find(allowed_origins_.begin(), allowed_origins_.end(), origin) !=
         allowed_origins_.end();
}

bool HttpPolicy::IsOwnOrigin(std::string_view origin, std::string_view host) const {
  // A proxy in front may serve the page by https.
  for (const std::string_view scheme : {"http://", "https://"}) {
    if (origin.starts_with(scheme)) {
      return boost::beast::iequals(BeastView(origin.substr(scheme.size())), BeastView(host));
    }
  }
  return false;
}

void HttpPolicy::Decorate(std::string_view origin, http::fields& response) const {
  response.set("X-Content-Type-Options", "nosniff");
  response.set("Content-Security-Policy", kContentSecurityPolicy);
  response.set("Referrer-Policy", "no-referrer");
  if (allowed_origins_.empty()) return;
  const std::string varies = response[http::field::vary].to_string();
  response.set(http::field::vary, varies.empty() ? "Origin" : varies + ", Origin");
  if (!AllowsOrigin(origin)) return;
  response.set(http::field::access_control_allow_origin, BeastView(origin));
  // Metadata may have any name; without credentials the asterisk matches all.
  response.set(http::field::access_control_expose_headers, "*");
}

void HttpPolicy::DecoratePreflight(std::string_view asked_headers, http::fields& response) const {
  response.set(http::field::access_control_allow_methods, "GET, HEAD, POST, OPTIONS");
  if (!asked_headers.empty()) {
    response.set(http::field::access_control_allow_headers, BeastView(asked_headers));
  }
  response.set(http::field::access_control_max_age, "7200");
}

}  // namespace thunderhead::gateway
