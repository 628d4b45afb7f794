#include "gateway/grpc_web_exchange.h"

#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/serializer.hpp>
#include <boost/beast/http/write.hpp>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "absl/strings/str_format.h"
#include "base/status.h"
#include "gateway/call_header.h"
#include "gateway/message_slices.h"
#include "gateway/refusals.h"
#include "gateway/text_view.h"

namespace thunderhead::gateway {
namespace {

namespace net = boost::asio;
namespace http = boost::beast::http;

}  // namespace

net::awaitable<bool> GrpcWebExchange::Run() {
  const absl::StatusOr<UpstreamRequest> upstream = Translate();
  if (!upstream.ok()) {
    const bool keep = co_await Refuse(upstream.status(), request_.keep_alive());
    co_return keep;
  }
  const UpstreamCall::Lease call =
      UpstreamCall::Start(site_.stub, link_.Stream().get_executor(), *upstream);
  link_.StartWatching([shared = call.Share()] { shared->Cancel(); });
  const bool written = co_await Relay(call);
  co_await link_.StopWatching();
  co_return written && !link_.Gone() && request_.keep_alive();
}

net::awaitable<bool> GrpcWebExchange::Refuse(const absl::Status& status, bool keep_alive) {
  const std::string message(status.message());
  const bool keep = co_await WriteTrailersOnly(Trailers(status.code(), message, {}), keep_alive);
  co_return keep;
}

absl::StatusOr<UpstreamRequest> GrpcWebExchange::Translate() const {
  THUNDERHEAD_ASSIGN_OR_RETURN(
      UpstreamRequest upstream,
      TranslateHeader(request_, link_.Peer(), site_.options.trusted_proxies));
  THUNDERHEAD_ASSIGN_OR_RETURN(upstream.only_message, TakeSingleMessage(request_.body()));
  return upstream;
}

net::awaitable<bool> GrpcWebExchange::Relay(const UpstreamCall::Lease& call) {
  const bool has_headers = co_await call->AwaitHeaders();
  if (!has_headers) {
    const grpc::Status status = co_await call->Finish();
    const Metadata trailers = TrailersOf(status, call->TrailingMetadata());
    const bool written = co_await WriteTrailersOnly(trailers, request_.keep_alive());
    co_return written;
  }
  bool written = co_await WriteHeaders(call->InitialMetadata());
  while (written) {
    std::optional<grpc::ByteBuffer> message = co_await call->ReadMessage();
    if (!message.has_value()) break;
    const std::shared_ptr<const void> place = site_.unsent_answers.Take(link_, message->Length());
    if (place == nullptr) {
      written = co_await RefuseAnswer();
      co_return written;
    }
    written = co_await WriteMessage(std::move(*message));
  }
  if (!written) co_return false;
  const grpc::Status status = co_await call->Finish();
  const Metadata trailers = TrailersOf(status, call->TrailingMetadata());
  written = co_await WriteTrailers(trailers);
  co_return written;
}

net::awaitable<bool> GrpcWebExchange::RefuseAnswer() {
  const absl::Status status = AnswersNotTaken();
  TellOfRefusal(site_.options, ClientOf(request_, link_.Peer(), site_.options.trusted_proxies),
                "Answer", status);
  const Metadata trailers = Trailers(status.code(), std::string(status.message()), {});
  const bool written = co_await WriteTrailers(trailers);
  co_return written;
}

net::awaitable<bool> GrpcWebExchange::WriteHeaders(const Metadata& metadata) {
  http::response<http::empty_body> response(http::status::ok, request_.version());
  Prepare(response, metadata);
  response.keep_alive(request_.keep_alive());
  response.chunked(true);
  http::response_serializer<http::empty_body> serializer(response);
  link_.ExpireIdleWrite();
  boost::system::error_code error;
  co_await http::async_write_header(link_.Stream(), serializer,
                                    net::redirect_error(net::use_awaitable, error));
  co_return !error;
}

net::awaitable<bool> GrpcWebExchange::WriteMessage(grpc::ByteBuffer message) {
  const MessageSlices slices(message);
  const auto frame = MessageFrameHeader(static_cast<uint32_t>(slices.SizeBytes()));
  // The message is sent as a chunk, directly from gRPC's memory.
  const std::string chunk = absl::StrFormat("%x\r\n", slices.SizeBytes() + frame.size());
  std::vector<net::const_buffer> buffers = {net::buffer(chunk), net::buffer(frame)};
  slices.AppendTo(buffers);
  buffers.emplace_back("\r\n", 2);
  const bool written = co_await link_.WriteAll(
      std::move(buffers), site_.Now() + site_.options.DeliveryTime(slices.SizeBytes()));
  co_return written;
}

net::awaitable<bool> GrpcWebExchange::WriteTrailers(const Metadata& trailers) {
  const std::string frame = TrailerFrame(trailers);
  const std::string end = absl::StrFormat("%x\r\n%s\r\n0\r\n\r\n", frame.size(), frame);
  std::vector<net::const_buffer> buffers = {net::buffer(end)};
  const bool written = co_await link_.WriteAll(
      std::move(buffers), site_.Now() + site_.options.DeliveryTime(end.size()));
  co_return written;
}

net::awaitable<bool> GrpcWebExchange::WriteTrailersOnly(const Metadata& trailers, bool keep_alive) {
  http::response<http::empty_body> response(http::status::ok, request_.version());
  Prepare(response, trailers);
  response.keep_alive(keep_alive);
  response.content_length(0);
  link_.ExpireIdleWrite();
  boost::system::error_code error;
  co_await http::async_write(link_.Stream(), response,
                             net::redirect_error(net::use_awaitable, error));
  co_return !error && keep_alive;
}

template <typename Response>
void GrpcWebExchange::Prepare(Response& response, const Metadata& metadata) const {
  for (const auto& [name, value] : metadata) response.insert(name, value);
  response.set(http::field::content_type, request_[http::field::content_type]);
  response.set(http::field::cache_control, "no-store");
  site_.policy.Decorate(View(request_[http::field::origin]), response);
}

}  // namespace thunderhead::gateway
