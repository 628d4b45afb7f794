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

// Method, metadata and deadline of the call that `request` asks for; no message. The service is
// told that it is for `peer`, the client's address, by x-forwarded-for; or for the client that
// `peer` names there, if it is one of `proxies`.
absl::StatusOr<UpstreamRequest> TranslateHeader(
    const boost::beast::http::request<boost::beast::http::string_body>& request,
    const std::string& peer, const base::TrustedProxies& proxies);

// The trailers of a call that ended with `status`, encoded for the wire.
Metadata TrailersOf(const grpc::Status& status, const Metadata& metadata);

}  // namespace thunderhead::gateway
