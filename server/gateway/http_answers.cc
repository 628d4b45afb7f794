#include "gateway/http_answers.h"

#include <boost/beast/http/serializer.hpp>
#include <boost/beast/http/write.hpp>
#include <utility>

#include "gateway/call_header.h"
#include "gateway/refusals.h"
#include "gateway/text_view.h"

namespace thunderhead::gateway {
namespace {

namespace net = boost::asio;
namespace http = boost::beast::http;
using boost::system::error_code;

// Retry delay in seconds for a file whose storage hangs.
constexpr char kFileRetry[] = "10";

}  // namespace

template <typename Body>
bool HttpAnswers::CompleteAny(const Request& request, http::response<Body>& response) {
  const bool keep_alive = request.keep_alive() && !unread_input_;
  site_.policy.Decorate(View(request[http::field::origin]), response);
  response.keep_alive(keep_alive);
  link_.Begin(LinkUse::kSending);
  return keep_alive;
}

template <typename Body>
net::awaitable<bool> HttpAnswers::SendAny(const Request& request, http::response<Body>& response) {
  const bool keep_alive = CompleteAny(request, response);
  http::response_serializer<Body> serializer(response);
  const auto end = EndOfSending(response.payload_size().value_or(0));
  // The response is written in parts, and each part gets the stall timeout. So a write without
  // progress times out.
  while (!serializer.is_done()) {
    link_.ExpireIdleWrite(end);
    error_code error;
    co_await http::async_write_some(link_.Stream(), serializer,
                                    net::redirect_error(net::use_awaitable, error));
    if (error) co_return false;
  }
  co_return keep_alive;
}

bool HttpAnswers::Complete(const Request& request, Header& header) {
  return CompleteAny(request, header);
}

net::awaitable<bool> HttpAnswers::Send(const Request& request, Header& header) {
  const bool keep = co_await SendAny(request, header);
  co_return keep;
}

net::awaitable<bool> HttpAnswers::SendText(const Request& request, http::status status,
                                           const std::string& text,
                                           std::string_view allowed_methods) {
  http::response<http::empty_body> header(status, request.version());
  header.set(http::field::content_type, "text/plain; charset=utf-8");
  header.set(http::field::cache_control, "no-store");
  if (!allowed_methods.empty()) header.set(http::field::allow, BeastView(allowed_methods));
  if (status == http::status::service_unavailable) header.set(http::field::retry_after, kFileRetry);
  header.content_length(text.size());
  bool keep = false;
  if (request.method() == http::verb::head) {
    keep = co_await Send(request, header);
    co_return keep;
  }
  http::response<http::string_body> response(std::move(header.base()), text);
  keep = co_await SendAny(request, response);
  co_return keep;
}

ClientLink::Clock::time_point HttpAnswers::EndOfSending(std::uint64_t bytes) const {
  return site_.Now() + site_.options.DeliveryTime(bytes);
}

std::string HttpAnswers::OwnerOf(const Request& request) const {
  return ClientOf(request, link_.Peer(), site_.options.trusted_proxies);
}

void HttpAnswers::Tell(const Request& request, const char* act, const absl::Status& refusal) const {
  TellOfRefusal(site_.options, OwnerOf(request), act, refusal);
}

}  // namespace thunderhead::gateway
