// Shared by gRPC-Web and WebSocket calls: a call's HTTP header as an upstream request, and its
// outcome as trailers. Knows no socket and no message.
#pragma once

#include <boost/beast/http/message.hpp>
#include <boost/beast/http/string_body.hpp>
#include <string>

#include "absl/status/statusor.h"
#include "base/trusted_proxies.h"
#include "gateway/grpc_web_protocol.h"
#include "gateway/upstream_call.h"
#include "grpcpp/support/status.h"

namespace thunderhead::gateway {

// For whom `request` is: `peer`, the client's address, or the client that `peer` names by
// x-forwarded-for if it is one of `proxies`.
std::string ClientOf(const boost::beast::http::request<boost::beast::http::string_body>& request,
                     const std::string& peer, const base::TrustedProxies& proxies);

// Method, metadata and deadline of the call that `request` asks for; no message. The service is
// told for whom it is by x-forwarded-for.
absl::StatusOr<UpstreamRequest> TranslateHeader(
    const boost::beast::http::request<boost::beast::http::string_body>& request,
    const std::string& peer, const base::TrustedProxies& proxies);

// The trailers of a call that ended with `status`, encoded for the wire.
Metadata TrailersOf(const grpc::Status& status, const Metadata& metadata);

}  // namespace thunderhead::gateway
