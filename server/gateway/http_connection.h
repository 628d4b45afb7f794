// Serves one HTTP/1.1 connection. It reads requests within their limits and dispatches each to the
// page, the health check, the cross-origin preflight, the gRPC-Web bridge or a WebSocket.
#pragma once

#include <memory>

#include "gateway/awaitable.h"
#include "gateway/client_link.h"
#include "gateway/site.h"

namespace thunderhead::gateway {

// Serves the connection and closes `link` at the end. It throws nothing. `site` must outlive the
// call.
boost::asio::awaitable<void> ServeConnection(std::shared_ptr<ClientLink> link, Site& site);

}  // namespace thunderhead::gateway
