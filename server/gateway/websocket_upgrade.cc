#include "gateway/websocket_upgrade.h"

#include <boost/beast/http/field.hpp>
#include <iterator>
#include <string>
#include <string_view>

#include "absl/strings/escaping.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "gateway/text_view.h"
#include "gateway/websocket_protocol.h"

namespace thunderhead::gateway {

namespace http = boost::beast::http;

namespace {

// Returns whether the request has one Sec-WebSocket-Key, of 16 bytes in base64 (RFC 6455, 4.1).
bool HasKey(const http::request<http::string_body>& request) {
  constexpr std::size_t kBytes = 16;
  constexpr std::size_t kCharacters = 24;
  const auto [begin, end] = request.equal_range(http::field::sec_websocket_key);
  if (std::distance(begin, end) != 1) return false;
  const std::string_view text = View(begin->value());
  const absl::string_view key(text.data(), text.size());
  std::string bytes;
  return key.size() == kCharacters && absl::EndsWith(key, "==") &&
         absl::Base64Unescape(key, &bytes) && bytes.size() == kBytes;
}

}  // namespace

std::optional<UpgradeRefusal> FindUpgradeRefusal(const http::request<http::string_body>& request,
                                                 const HttpPolicy& policy) {
  // Browsers let any page open a WebSocket to any server, so the server must refuse foreign
  // origins.
  const std::string_view origin = View(request[http::field::origin]);
  if (!policy.MayCall(origin, View(request[http::field::host]))) {
    return UpgradeRefusal{
        http::status::forbidden,
        absl::StrCat("Pages of ", std::string(origin), " may not call this server; start it with ",
                     "--allow-origin ", std::string(origin), " to allow that.\n")};
  }
  if (!HasKey(request)) {
    return UpgradeRefusal{
        http::status::bad_request,
        "A WebSocket needs exactly one header Sec-WebSocket-Key, with 16 bytes in "
        "base64; send a new random key.\n"};
  }
  const auto [begin, end] = request.equal_range(http::field::sec_websocket_protocol);
  for (auto field = begin; field != end; ++field) {
    if (OffersSubprotocol(View(field->value()))) return std::nullopt;
  }
  return UpgradeRefusal{http::status::bad_request,
                        absl::StrCat("Calls by WebSocket need the header Sec-WebSocket-Protocol: ",
                                     kWebSocketSubprotocol, ".\n")};
}

}  // namespace thunderhead::gateway
