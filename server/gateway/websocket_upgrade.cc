#include "gateway/websocket_upgrade.h"

#include <boost/beast/http/field.hpp>
#include <string_view>

#include "absl/strings/str_cat.h"
#include "gateway/text_view.h"
#include "gateway/websocket_protocol.h"

namespace thunderhead::gateway {

namespace http = boost::beast::http;

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
  const auto [begin, end] = request.equal_range(http::field::sec_websocket_protocol);
  for (auto field = begin; field != end; ++field) {
    if (OffersSubprotocol(View(field->value()))) return std::nullopt;
  }
  return UpgradeRefusal{http::status::bad_request,
                        absl::StrCat("Calls by WebSocket need the header Sec-WebSocket-Protocol: ",
                                     kWebSocketSubprotocol, ".\n")};
}

}  // namespace thunderhead::gateway
