// Decides which upgrade requests become WebSockets, and gives the reason for refusing the others.
// It is independent of sockets.
#pragma once

#include <boost/beast/http/message.hpp>
#include <boost/beast/http/status.hpp>
#include <boost/beast/http/string_body.hpp>
#include <optional>
#include <string>

#include "gateway/http_policy.h"

namespace thunderhead::gateway {

struct UpgradeRefusal {
  boost::beast::http::status status;
  std::string text;
};

// Returns nothing if `request`, an upgrade at the path of a gRPC method, may become a WebSocket.
// Otherwise returns the refusal.
std::optional<UpgradeRefusal> FindUpgradeRefusal(
    const boost::beast::http::request<boost::beast::http::string_body>& request,
    const HttpPolicy& policy);

}  // namespace thunderhead::gateway
