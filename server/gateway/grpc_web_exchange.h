// One gRPC-Web request and its response: headers, messages and trailers in their frames. The next
// message is read from the server only after the client has accepted the previous one. Errors are
// sent as trailers with HTTP status 200, as clients expect. The exchange is independent of message
// types.
#pragma once

#include <boost/beast/http/message.hpp>
#include <boost/beast/http/string_body.hpp>

#include "absl/status/status.h"
#include "gateway/awaitable.h"
#include "gateway/client_link.h"
#include "gateway/grpc_web_protocol.h"
#include "gateway/site.h"
#include "gateway/upstream_call.h"

namespace thunderhead::gateway {

class GrpcWebExchange {
 public:
  using Request = boost::beast::http::request<boost::beast::http::string_body>;

  // All three arguments must outlive the exchange.
  GrpcWebExchange(Site& site, ClientLink& link, const Request& request)
      : site_(site), link_(link), request_(request) {}

  // Makes the call for the request, which must be complete. Returns false if the connection cannot
  // be used again.
  boost::asio::awaitable<bool> Run();
  // Responds without a call. If `keep_alive` is true, the connection may be used again.
  boost::asio::awaitable<bool> Refuse(const absl::Status& status, bool keep_alive);

 private:
  absl::StatusOr<UpstreamRequest> Translate() const;
  boost::asio::awaitable<bool> Relay(const UpstreamCall::Lease& call);
  // Ends a response whose headers were sent, because there is no memory for its message.
  boost::asio::awaitable<bool> RefuseAnswer();
  boost::asio::awaitable<bool> WriteHeaders(const Metadata& metadata);
  boost::asio::awaitable<bool> WriteMessage(grpc::ByteBuffer message);
  boost::asio::awaitable<bool> WriteTrailers(const Metadata& trailers);
  boost::asio::awaitable<bool> WriteTrailersOnly(const Metadata& trailers, bool keep_alive);
  template <typename Response>
  void Prepare(Response& response, const Metadata& metadata) const;

  Site& site_;
  ClientLink& link_;
  const Request& request_;
};

}  // namespace thunderhead::gateway
