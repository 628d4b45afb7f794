// One HTTP/1.1 connection from its first request to its end: reads requests within their limits and
// gives each to the page, the health check, the cross-origin preflight or the gRPC-Web bridge.
#pragma once

#include <memory>

#include "gateway/awaitable.h"
#include "gateway/client_link.h"
#include "gateway/site.h"

namespace thunderhead::gateway {

// Ends with `link` closed and throws nothing. `site` outlives it.
boost::asio::awaitable<void> ServeConnection(std::shared_ptr<ClientLink> link, Site& site);

}  // namespace thunderhead::gateway
