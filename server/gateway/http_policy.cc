#include "gateway/http_policy.h"

#include <algorithm>
#include <boost/asio/ip/address.hpp>
#include <boost/asio/ip/host_name.hpp>
#include <boost/beast/http/field.hpp>
#include <string>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "base/digits.h"
#include "gateway/text_view.h"

namespace thunderhead::gateway {
namespace {

namespace http = boost::beast::http;

// The policy allows what the page needs: pictures are blobs, the decoding worker may be created
// from a blob, and sliders have inline styles.
constexpr char kContentSecurityPolicy[] =
    "default-src 'self'; img-src 'self' blob: data:; worker-src 'self' blob:; "
    "style-src 'self' 'unsafe-inline'; object-src 'none'; base-uri 'self'; frame-ancestors 'self'";

// Returns the name in a Host header: "localhost" for "LocalHost:8080" and "[::1]" for "[::1]:8080".
// Returns nothing if the name is followed by anything but a valid port.
std::optional<std::string> NameOfHost(std::string_view host) {
  const size_t bracket = host.find(']');
  const size_t colon = host.find(':', bracket == std::string_view::npos ? 0 : bracket);
  if (colon != std::string_view::npos) {
    constexpr size_t kMostDigits = 5;
    const std::string_view port = host.substr(colon + 1);
    if (port.size() > kMostDigits || !base::IsDigits(port)) return std::nullopt;
  }
  return absl::AsciiStrToLower(std::string(host.substr(0, colon)));
}

// Returns true if the request has no Transfer-Encoding header, or exactly one, whose value is only
// `chunked`.
bool HasPlainEncoding(const http::request_header<>& request) {
  const auto count = request.count(http::field::transfer_encoding);
  return count == 0 ||
         (count == 1 && boost::beast::iequals(request[http::field::transfer_encoding], "chunked"));
}

// Returns true for addresses such as "192.0.2.7" and "[2001:db8::7]".
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

std::optional<std::string> FindAmbiguity(const http::request_header<>& request) {
  for (const http::field field :
       {http::field::host, http::field::origin, http::field::content_length,
        http::field::content_type, http::field::content_encoding, http::field::authorization,
        http::field::range, http::field::if_range}) {
    if (request.count(field) > 1) {
      return absl::StrCat("A request must have one ", std::string(View(http::to_string(field))),
                          " header, not several.\n");
    }
  }
  const auto coding = request[http::field::content_encoding];
  if (!coding.empty() && !boost::beast::iequals(coding, "identity")) {
    return "A request's body must have no Content-Encoding; send it unencoded.\n";
  }
  if (!HasPlainEncoding(request))
    return "The only supported Transfer-Encoding is 'chunked', given once.\n";
  const bool has_encoding = request.count(http::field::transfer_encoding) > 0;
  if (has_encoding && request.count(http::field::content_length) > 0) {
    return "A request must have Transfer-Encoding or Content-Length, not both.\n";
  }
  if (has_encoding && request.version() < 11) {
    return "A request by HTTP/1.0 must have no Transfer-Encoding; send Content-Length.\n";
  }
  if (!NameOfHost(View(request[http::field::host])).has_value()) {
    return "The Host header's port is not a number.\n";
  }
  return std::nullopt;
}

bool HttpPolicy::AllowsHost(std::string_view host) const {
  const std::optional<std::string> named = NameOfHost(host);
  if (!named.has_value()) return false;
  const std::string& name = *named;
  if (name == "localhost" || name == "127.0.0.1" || name == "[::1]") return true;
  return std::ranges::find(allowed_hosts_, name) != allowed_hosts_.end() ||
         (!loopback_ && IsAddress(name));
}

bool HttpPolicy::AllowsOrigin(std::string_view origin) const {
  return std::find(allowed_origins_.begin(), allowed_origins_.end(), origin) !=
         allowed_origins_.end();
}

bool HttpPolicy::MayCall(std::string_view origin, std::string_view host) const {
  return origin.empty() || AllowsOrigin(origin) || IsOwnOrigin(origin, host);
}

bool HttpPolicy::IsOwnOrigin(std::string_view origin, std::string_view host) const {
  // Both schemes are accepted, because a proxy in front may serve the page by https.
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
  // The asterisk exposes all response headers for requests without credentials. It is needed
  // because metadata may have any name.
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
