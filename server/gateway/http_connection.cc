#include "gateway/http_connection.h"

#include <algorithm>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/error.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/beast/http/write.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "absl/strings/str_cat.h"
#include "gateway/call_header.h"
#include "gateway/file_answers.h"
#include "gateway/grpc_web_exchange.h"
#include "gateway/grpc_web_protocol.h"
#include "gateway/http_answers.h"
#include "gateway/refusals.h"
#include "gateway/text_view.h"
#include "gateway/websocket_exchange.h"
#include "gateway/websocket_upgrade.h"
#include "spdlog/spdlog.h"

namespace thunderhead::gateway {
namespace {

namespace net = boost::asio;
namespace http = boost::beast::http;
using boost::system::error_code;
using Request = GrpcWebExchange::Request;

constexpr uint32_t kMaxHeaderBytes = 16 << 10;
constexpr size_t kFirstRead = 4 << 10;
constexpr char kPageMethods[] = "GET, HEAD";

// Returns whether a line of a header begins with a space or a tab. Such a line continues the line
// before it (obs-fold, RFC 9112, 5.2). The text begins at the start of a line.
bool HasFoldedLine(std::string_view received) {
  constexpr std::string_view kLineEnd = "\r\n";
  while (true) {
    const size_t end = received.find(kLineEnd);
    // An empty line ends the header.
    if (end == std::string_view::npos || end == 0) return false;
    received.remove_prefix(end + kLineEnd.size());
    if (received.starts_with(' ') || received.starts_with('\t')) return true;
  }
}

std::string_view TextOf(const boost::beast::flat_buffer& buffer) {
  return {static_cast<const char*>(buffer.cdata().data()), buffer.size()};
}

class HttpConnection {
 public:
  HttpConnection(ClientLink& link, Site& site)
      : link_(link), site_(site), answers_(link, site), files_(answers_, link, site) {}

  // Serves one request. Returns false if it was the last request of the connection.
  net::awaitable<bool> ServeOne();
  // Returns true if the client may still be sending.
  bool HasUnreadInput() const { return answers_.HasUnreadInput(); }

 private:
  using Parser = http::request_parser<http::string_body>;

  // Waits for the first byte of a request. Returns false if none arrives.
  net::awaitable<bool> AwaitRequest();
  net::awaitable<bool> Answer(Parser& parser);
  net::awaitable<bool> AnswerPage(const Request& request, const std::string& path);
  net::awaitable<bool> AnswerUpgrade(const Request& request);
  net::awaitable<bool> RefuseOrigin(const Request& request, const char* what);
  net::awaitable<bool> AnswerPost(Parser& parser, const std::string& path);
  net::awaitable<bool> AnswerOptions(const Request& request);
  net::awaitable<bool> AnswerCall(Parser& parser);
  net::awaitable<bool> AnswerBadHeader(error_code error);
  net::awaitable<bool> RefuseLargeCall(const Request& request);
  // Reads a request's header. Returns bad_obs_fold if a line of it continues on the next line.
  net::awaitable<error_code> ReadHeader(Parser& parser);
  net::awaitable<error_code> ReadBody(Parser& parser);
  // Tells the client that its request cannot be parsed. Sends nothing if the error is that the
  // client has left, and nothing for a timeout or a network error.
  net::awaitable<bool> AnswerUnparsed(const Request& request, const char* part, error_code error);

  ClientLink& link_;
  Site& site_;
  HttpAnswers answers_;
  FileAnswers files_;
  bool is_first_ = true;
};

net::awaitable<bool> HttpConnection::ServeOne() {
  Parser parser;
  parser.header_limit(kMaxHeaderBytes);
  // The real limit of the body is set after the header was read. Until then there is no limit,
  // because boost::none would refuse every body in Beast 1.74.
  parser.body_limit(std::numeric_limits<uint64_t>::max());
  const bool begins = co_await AwaitRequest();
  if (!begins) co_return false;
  link_.Begin(LinkUse::kReceiving);
  // The timeout covers the whole header. It is not restarted for each part of the header.
  link_.Stream().expires_after(site_.options.header_timeout);
  const error_code error = co_await ReadHeader(parser);
  link_.Begin(LinkUse::kSending);
  if (error) {
    const bool keep = co_await AnswerBadHeader(error);
    co_return keep;
  }
  answers_.SetUnreadInput(!parser.is_done());
  const bool keep = co_await Answer(parser);
  co_return keep && !answers_.HasUnreadInput();
}

// Beast joins folded lines without reporting it, so they are searched for before Beast parses them.
// The search sees every line whole, because Beast consumes a line only when the first byte of the
// next line has arrived.
net::awaitable<error_code> HttpConnection::ReadHeader(Parser& parser) {
  error_code error;
  while (!parser.is_header_done()) {
    if (link_.Received().size() > 0) {
      if (HasFoldedLine(TextOf(link_.Received()))) co_return http::error::bad_obs_fold;
      link_.Received().consume(parser.put(link_.Received().cdata(), error));
      if (!error) continue;
      if (error != http::error::need_more) co_return error;
    }
    const size_t room = link_.Received().max_size() - link_.Received().size();
    if (room == 0) co_return http::error::buffer_overflow;
    const size_t bytes = co_await link_.Stream().async_read_some(
        link_.Received().prepare(std::min(kFirstRead, room)),
        net::redirect_error(net::use_awaitable, error));
    link_.Received().commit(bytes);
    if (error == net::error::eof) co_return http::error::end_of_stream;
    if (error) co_return error;
  }
  co_return error;
}

net::awaitable<bool> HttpConnection::AwaitRequest() {
  link_.Begin(LinkUse::kWaiting);
  if (link_.Received().size() > 0) co_return true;
  link_.Stream().expires_after(is_first_ ? site_.options.header_timeout
                                         : site_.options.idle_timeout);
  is_first_ = false;
  error_code error;
  const size_t bytes = co_await link_.Stream().async_read_some(
      link_.Received().prepare(kFirstRead), net::redirect_error(net::use_awaitable, error));
  link_.Received().commit(bytes);
  co_return !error;
}

net::awaitable<bool> HttpConnection::Answer(Parser& parser) {
  const Request& request = parser.get();
  const std::string_view host = View(request[http::field::host]);
  const std::string_view target = View(request.target());
  const std::string path(target.substr(0, target.find('?')));
  bool keep = false;
  if (const auto ambiguity = FindAmbiguity(request); ambiguity.has_value()) {
    // The bytes after the header may belong to this request or to another one. So no further
    // request is read from the connection.
    answers_.SetUnreadInput(true);
    keep = co_await answers_.SendText(request, http::status::bad_request, *ambiguity);
  } else if (!site_.policy.AllowsHost(host)) {
    answers_.Tell(request, "Request", HostNotAllowed());
    keep = co_await answers_.SendText(
        request, http::status::forbidden,
        absl::StrCat("This server does not answer to '", std::string(host),
                     "'. Open it under a name that it knows, such as localhost, or start it with "
                     "--allow-host and this name.\n"));
  } else if (!path.starts_with('/') && path != "*") {
    keep =
        co_await answers_.SendText(request, http::status::bad_request,
                                   "The request's target must be a path that begins with '/'.\n");
  } else if (parser.is_done() && boost::beast::websocket::is_upgrade(request) &&
             IsMethodPath(path)) {
    keep = co_await AnswerUpgrade(request);
  } else if (request.method() == http::verb::get || request.method() == http::verb::head) {
    keep = co_await AnswerPage(request, path);
  } else if (request.method() == http::verb::post) {
    keep = co_await AnswerPost(parser, path);
  } else if (request.method() == http::verb::options) {
    keep = co_await AnswerOptions(request);
  } else {
    keep = co_await answers_.SendText(request, http::status::method_not_allowed,
                                      "Only GET, HEAD, POST and OPTIONS are supported.\n",
                                      "GET, HEAD, POST, OPTIONS");
  }
  co_return keep;
}

net::awaitable<bool> HttpConnection::AnswerPage(const Request& request, const std::string& path) {
  bool keep = false;
  if (path == "/healthz") {
    keep = co_await answers_.SendText(request, http::status::ok, "ok\n");
    co_return keep;
  }
  const std::optional<KeptFile> kept =
      site_.options.find_kept_file ? site_.options.find_kept_file(path) : std::nullopt;
  if (kept.has_value()) {
    keep = co_await files_.SendKept(request, *kept);
    co_return keep;
  }
  const absl::StatusOr<PageFile> page = co_await files_.FindPageFile(request, path);
  if (!page.ok()) {
    keep = co_await files_.SendStorageFails(request);
  } else if (page->about.has_value()) {
    keep = co_await files_.SendFile(request, *page);
  } else if (IsMethodPath(path) && path.find('.') < path.rfind('/')) {
    keep = co_await answers_.SendText(
        request, http::status::method_not_allowed,
        "This is the path of a gRPC method; call it with POST and gRPC-Web, or by a WebSocket "
        "of subprotocol grpc-websocket.v1.\n",
        "POST, OPTIONS");
  } else {
    keep = co_await answers_.SendText(request, http::status::not_found,
                                      "There is nothing at this path.\n");
  }
  co_return keep;
}

net::awaitable<bool> HttpConnection::AnswerUpgrade(const Request& request) {
  bool keep = false;
  if (const auto refusal = FindUpgradeRefusal(request, site_.policy); refusal.has_value()) {
    if (refusal->status == http::status::forbidden) {
      answers_.Tell(request, "WebSocket", OriginNotAllowed());
    }
    keep = co_await answers_.SendText(request, refusal->status, refusal->text);
    co_return keep;
  }
  const absl::StatusOr<UpstreamRequest> upstream =
      TranslateHeader(request, link_.Peer(), site_.options.trusted_proxies);
  if (!upstream.ok()) {
    keep = co_await answers_.SendText(request, http::status::bad_request,
                                      absl::StrCat(upstream.status().message(), ".\n"));
  } else if (link_.Received().size() > 0) {
    answers_.SetUnreadInput(true);
    keep = co_await answers_.SendText(request, http::status::bad_request,
                                      "Nothing may be sent before the upgrade is answered.\n");
  } else {
    // The exchange itself changes the use to kCalling when the service processes the call.
    link_.Begin(LinkUse::kReceiving);
    const auto exchange = std::make_shared<WebSocketExchange>(site_, link_.shared_from_this());
    co_await exchange->Run(request, *upstream);
  }
  co_return keep;
}

net::awaitable<bool> HttpConnection::RefuseOrigin(const Request& request, const char* what) {
  const std::string origin(View(request[http::field::origin]));
  answers_.Tell(request, what, OriginNotAllowed());
  const bool keep = co_await answers_.SendText(
      request, http::status::forbidden,
      absl::StrCat("Pages of ", origin, " may not call this server; start it with --allow-origin ",
                   origin, " to allow that.\n"));
  co_return keep;
}

net::awaitable<bool> HttpConnection::AnswerPost(Parser& parser, const std::string& path) {
  const Request& request = parser.get();
  bool keep = false;
  if (!site_.policy.MayCall(View(request[http::field::origin]), View(request[http::field::host]))) {
    keep = co_await RefuseOrigin(request, "Request");
    co_return keep;
  }
  // Calls are recognised before any file is looked for, because the files' storage may hang.
  const bool is_call =
      IsMethodPath(path) && IsBinaryGrpcWeb(View(request[http::field::content_type]));
  if (is_call && request.version() < 11) {
    keep = co_await answers_.SendText(
        request, http::status::http_version_not_supported,
        "Calls need HTTP/1.1, because responses are streamed in chunks.\n");
    co_return keep;
  }
  if (is_call) {
    keep = co_await AnswerCall(parser);
    co_return keep;
  }
  const absl::StatusOr<PageFile> page = co_await files_.FindPageFile(request, path);
  if (!page.ok()) {
    keep = co_await files_.SendStorageFails(request);
  } else if (path == "/healthz" || page->about.has_value()) {
    keep = co_await answers_.SendText(request, http::status::method_not_allowed,
                                      "Read this path with GET.\n", kPageMethods);
  } else if (!IsMethodPath(path)) {
    keep = co_await answers_.SendText(request, http::status::not_found,
                                      "There is nothing at this path; gRPC methods are at "
                                      "/package.Service/Method.\n");
  } else {
    keep = co_await answers_.SendText(
        request, http::status::unsupported_media_type,
        "Send calls as application/grpc-web or "
        "application/grpc-web+proto; grpc-web-text, JSON and plain gRPC are "
        "not supported on this port.\n");
  }
  co_return keep;
}

net::awaitable<bool> HttpConnection::AnswerOptions(const Request& request) {
  const std::string_view origin = View(request[http::field::origin]);
  if (!origin.empty() && !site_.policy.AllowsOrigin(origin)) {
    const bool keep = co_await RefuseOrigin(request, "Preflight");
    co_return keep;
  }
  http::response<http::empty_body> response(http::status::no_content, request.version());
  response.set(http::field::allow, "GET, HEAD, POST, OPTIONS");
  if (!origin.empty()) {
    site_.policy.DecoratePreflight(View(request[http::field::access_control_request_headers]),
                                   response);
  }
  const bool keep = co_await answers_.Send(request, response);
  co_return keep;
}

net::awaitable<bool> HttpConnection::AnswerCall(Parser& parser) {
  const Request& request = parser.get();
  const uint64_t limit = site_.options.max_message_bytes + kFrameHeaderBytes;
  bool keep = false;
  if (parser.content_length().value_or(0) > limit) {
    keep = co_await RefuseLargeCall(request);
    co_return keep;
  }
  parser.body_limit(limit);
  const error_code error = co_await ReadBody(parser);
  if (error == http::error::body_limit) {
    keep = co_await RefuseLargeCall(request);
  } else if (!error) {
    answers_.SetUnreadInput(false);
    link_.Begin(LinkUse::kCalling);
    keep = co_await GrpcWebExchange(site_, link_, request).Run();
  } else {
    keep = co_await AnswerUnparsed(request, "body", error);
  }
  co_return keep;
}

net::awaitable<error_code> HttpConnection::ReadBody(Parser& parser) {
  error_code error;
  if (parser.is_done()) co_return error;
  if (boost::beast::iequals(parser.get()[http::field::expect], "100-continue")) {
    http::response<http::empty_body> response(http::status::continue_, 11);
    link_.ExpireIdleWrite();
    co_await http::async_write(link_.Stream(), response,
                               net::redirect_error(net::use_awaitable, error));
    if (error) co_return error;
  }
  link_.Begin(LinkUse::kReceiving);
  link_.Stream().expires_after(GatewayOptions::kHeaderTimeouts * site_.options.header_timeout);
  // Beast adds the fields behind the last chunk (trailers, RFC 9112 section 7.1.2) to the header,
  // which was checked before. These fields are dropped. Otherwise a client behind a trusted proxy
  // could add an X-Forwarded-For that the proxy has not seen, and be taken for another client.
  std::optional<http::request_header<>> header;
  if (parser.chunked()) header = parser.get().base();
  co_await http::async_read(link_.Stream(), link_.Received(), parser,
                            net::redirect_error(net::use_awaitable, error));
  if (header.has_value()) parser.get().base() = *std::move(header);
  link_.Begin(LinkUse::kSending);
  co_return error;
}

net::awaitable<bool> HttpConnection::RefuseLargeCall(const Request& request) {
  answers_.Tell(request, "Message", MessageTooLarge());
  const absl::Status status = absl::ResourceExhaustedError(
      absl::StrCat("the request message is larger than the ", site_.options.max_message_bytes,
                   " bytes that this server accepts"));
  GrpcWebExchange exchange(site_, link_, request);
  const bool keep = co_await exchange.Refuse(status, /*keep_alive=*/false);
  co_return keep;
}

net::awaitable<bool> HttpConnection::AnswerBadHeader(error_code error) {
  Request request;
  request.version(11);
  request.keep_alive(false);
  if (error == http::error::header_limit || error == http::error::buffer_overflow) {
    answers_.Tell(request, "Request", HeaderTooLarge());
  }
  const bool keep = co_await AnswerUnparsed(request, "header", error);
  co_return keep;
}

net::awaitable<bool> HttpConnection::AnswerUnparsed(const Request& request, const char* part,
                                                    error_code error) {
  if (error.category() != http::make_error_code(http::error::bad_method).category() ||
      error == http::error::end_of_stream || error == http::error::partial_message) {
    co_return false;
  }
  // The bytes that follow may belong to this request or to another one, so none of them is read.
  answers_.SetUnreadInput(true);
  const bool too_large =
      error == http::error::header_limit || error == http::error::buffer_overflow;
  const std::string why =
      error == http::error::bad_obs_fold
          ? "a line begins with a space or a tab, and so continues the line before it (RFC 9112, "
            "5.2); send each field on one line"
          : error.message();
  const bool keep = co_await answers_.SendText(
      request,
      too_large ? http::status::request_header_fields_too_large : http::status::bad_request,
      absl::StrCat("Cannot parse the request's ", part, ": ", why, ".\n"));
  co_return keep;
}

}  // namespace

net::awaitable<void> ServeConnection(std::shared_ptr<ClientLink> link, Site& site) {
  try {
    link->Stream().expires_after(site.options.header_timeout);
    bool keep = co_await link->Stream().Handshake();
    HttpConnection connection(*link, site);
    while (keep) keep = co_await connection.ServeOne();
    if (connection.HasUnreadInput()) co_await link->LingeringClose();
  } catch (const std::exception& error) {
    spdlog::error("closing a browser's connection after an internal error: {}", error.what());
  }
  link->Close();
}

}  // namespace thunderhead::gateway
