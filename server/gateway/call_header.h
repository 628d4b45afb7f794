// Converts a call's HTTP header to an upstream request, and the call's outcome to trailers. Both
// gRPC-Web and WebSocket calls use it. It depends on no socket and no message type.
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

// Returns the address of the client that made `request`: the address in X-Forwarded-For if `peer`
// is one of `proxies`, otherwise `peer`.
std::string ClientOf(const boost::beast::http::request<boost::beast::http::string_body>& request,
                     const std::string& peer, const base::TrustedProxies& proxies);

// Returns the method, metadata and deadline of the call that `request` asks for, without a message.
// The metadata x-forwarded-for holds the client's address for the service. Returns INVALID_ARGUMENT
// for a malformed timeout, or for a header that cannot be gRPC metadata.
absl::StatusOr<UpstreamRequest> TranslateHeader(
    const boost::beast::http::request<boost::beast::http::string_body>& request,
    const std::string& peer, const base::TrustedProxies& proxies);

// Returns the trailers of a call that ended with `status`, encoded for the wire.
Metadata TrailersOf(const grpc::Status& status, const Metadata& metadata);

}  // namespace thunderhead::gateway
