#include "gateway/http_connection.h"

#include <algorithm>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/error.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/serializer.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/beast/http/write.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <cerrno>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <exception>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "base/client_network.h"
#include "gateway/byte_range.h"
#include "gateway/call_header.h"
#include "gateway/file_threads.h"
#include "gateway/grpc_web_exchange.h"
#include "gateway/grpc_web_protocol.h"
#include "gateway/open_file.h"
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
constexpr size_t kFilePart = 64 << 10;
// Seconds after which to ask again for a file whose storage hangs.
constexpr char kFileRetry[] = "10";

const char* PictureTypeOf(const std::string& path) {
  if (path.ends_with(".png")) return "image/png";
  if (path.ends_with(".jpeg")) return "image/jpeg";
  return "application/octet-stream";
}

void DescribeKept(const std::string& entity_tag, http::fields& header) {
  header.set(http::field::etag, entity_tag);
  header.set(http::field::cache_control, "private, no-cache");
  header.set(http::field::accept_ranges, "bytes");
}

// The result of looking for a page's file on a thread for files.
using FileOr = absl::StatusOr<std::shared_ptr<const OpenFile>>;
struct PageFile {
  std::optional<StaticFile> about;  // none: there is nothing at that path
  FileOr file = absl::NotFoundError("it was not opened");
};

// The part of a file that is sent.
struct FilePart {
  FileThreads& threads;
  std::string path;
  std::shared_ptr<const OpenFile> file;
  std::uint64_t first = 0;
  std::uint64_t bytes = 0;
};

class HttpConnection {
 public:
  HttpConnection(ClientLink& link, Site& site)
      : link_(link), site_(site), executor_(link.Stream().get_executor()) {}

  // False if it was the last request of the connection.
  net::awaitable<bool> ServeOne();
  // True if the client may still be sending.
  bool HasUnreadInput() const { return unread_input_; }

 private:
  using Parser = http::request_parser<http::string_body>;

  // Waits for the first byte of a request. False if none comes.
  net::awaitable<bool> AwaitRequest();
  net::awaitable<bool> Answer(Parser& parser);
  net::awaitable<bool> AnswerPage(const Request& request, const std::string& path);
  net::awaitable<bool> AnswerUpgrade(const Request& request);
  net::awaitable<bool> AnswerPost(Parser& parser, const std::string& path);
  net::awaitable<bool> AnswerOptions(const Request& request);
  net::awaitable<bool> AnswerCall(Parser& parser);
  net::awaitable<bool> AnswerBadHeader(error_code error);
  net::awaitable<bool> RefuseLargeCall(const Request& request);
  // Looks for the page's file at that path, and opens it if it is to be sent. An error if its
  // storage hangs.
  net::awaitable<absl::StatusOr<PageFile>> FindPageFile(const Request& request,
                                                        const std::string& path);
  net::awaitable<bool> SendFile(const Request& request, const PageFile& page);
  net::awaitable<bool> SendKept(const Request& request, const KeptFile& file);
  net::awaitable<bool> SendKeptPart(const Request& request, const KeptFile& file,
                                    std::shared_ptr<const OpenFile> opened);
  // Sends `header`, which must tell the part's length, and then the part.
  net::awaitable<bool> SendPart(const Request& request, http::response<http::empty_body>& header,
                                FilePart part);
  // Nothing of the file can be sent yet: its storage hangs or fails.
  net::awaitable<bool> SendStorageFails(const Request& request);
  void LogFailedRead(const std::string& path, const absl::Status& why);
  net::awaitable<bool> SendText(const Request& request, http::status status,
                                const std::string& text, std::string_view allowed_methods = {});
  template <typename Body>
  net::awaitable<bool> Send(const Request& request, http::response<Body>& response);
  // Completes a header that is to be sent; true if the connection may be used again afterwards.
  template <typename Body>
  bool Complete(const Request& request, http::response<Body>& response);
  ClientLink::Clock::time_point EndOfSending(std::uint64_t bytes) const;
  net::awaitable<error_code> ReadBody(Parser& parser);
  // The client's address, with its port where that is known.
  std::string OwnerOf(const Request& request) const {
    return ClientOf(request, link_.Peer(), site_.options.trusted_proxies);
  }
  // Whose work on files it is: all of a client's connections have one share of their threads.
  std::string FilesOwnerOf(const Request& request) const {
    return base::NetworkOf(OwnerOf(request));
  }
  void Tell(const Request& request, const char* act, const absl::Status& refusal) {
    TellOfRefusal(site_.options, OwnerOf(request), act, refusal);
  }

  ClientLink& link_;
  Site& site_;
  const net::any_io_executor executor_;
  bool is_first_ = true;
  bool unread_input_ = false;
  bool sent_whole_ = false;  // the last response
};

net::awaitable<bool> HttpConnection::ServeOne() {
  Parser parser;
  parser.header_limit(kMaxHeaderBytes);
  // The body's limit is set after the header has been read; boost::none would refuse every body in
  // Beast 1.74.
  parser.body_limit(std::numeric_limits<uint64_t>::max());
  const bool begins = co_await AwaitRequest();
  if (!begins) co_return false;
  link_.Begin(LinkUse::kReceiving);
  // For the whole of the header: the stream's time is not set anew for each of its parts.
  link_.Stream().expires_after(site_.options.header_timeout);
  error_code error;
  co_await http::async_read_header(link_.Stream(), link_.Received(), parser,
                                   net::redirect_error(net::use_awaitable, error));
  link_.Begin(LinkUse::kSending);
  if (error) {
    const bool keep = co_await AnswerBadHeader(error);
    co_return keep;
  }
  unread_input_ = !parser.is_done();
  const bool keep = co_await Answer(parser);
  co_return keep && !unread_input_;
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
  if (request.count(http::field::host) > 1) {
    keep = co_await SendText(request, http::status::bad_request,
                             "A request has one Host header, not several.\n");
  } else if (!site_.policy.AllowsHost(host)) {
    Tell(request, "Request", HostNotAllowed());
    keep = co_await SendText(request, http::status::forbidden,
                             absl::StrCat("This server does not answer to '", std::string(host),
                                          "'. Open it under a name that it knows, such as "
                                          "localhost, or start it with --allow-host and this "
                                          "one.\n"));
  } else if (!path.starts_with('/') && path != "*") {
    keep = co_await SendText(request, http::status::bad_request,
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
    keep = co_await SendText(request, http::status::method_not_allowed,
                             "Only GET, HEAD, POST and OPTIONS are supported.\n",
                             "GET, HEAD, POST, OPTIONS");
  }
  co_return keep;
}

net::awaitable<bool> HttpConnection::AnswerPage(const Request& request, const std::string& path) {
  bool keep = false;
  if (path == "/healthz") {
    keep = co_await SendText(request, http::status::ok, "ok\n");
    co_return keep;
  }
  const std::optional<KeptFile> kept =
      site_.options.find_kept_file ? site_.options.find_kept_file(path) : std::nullopt;
  if (kept.has_value()) {
    keep = co_await SendKept(request, *kept);
    co_return keep;
  }
  const absl::StatusOr<PageFile> page = co_await FindPageFile(request, path);
  if (!page.ok()) {
    keep = co_await SendStorageFails(request);
  } else if (page->about.has_value()) {
    keep = co_await SendFile(request, *page);
  } else if (IsMethodPath(path) && path.find('.') < path.rfind('/')) {
    keep = co_await SendText(
        request, http::status::method_not_allowed,
        "This is the path of a gRPC method; call it with POST and gRPC-Web, or by a WebSocket "
        "of subprotocol grpc-websocket.v1.\n",
        "POST, OPTIONS");
  } else {
    keep = co_await SendText(request, http::status::not_found, "There is nothing at this path.\n");
  }
  co_return keep;
}

net::awaitable<bool> HttpConnection::AnswerUpgrade(const Request& request) {
  bool keep = false;
  if (const auto refusal = FindUpgradeRefusal(request, site_.policy); refusal.has_value()) {
    if (refusal->status == http::status::forbidden) Tell(request, "WebSocket", OriginNotAllowed());
    keep = co_await SendText(request, refusal->status, refusal->text);
    co_return keep;
  }
  const absl::StatusOr<UpstreamRequest> upstream =
      TranslateHeader(request, link_.Peer(), site_.options.trusted_proxies);
  if (!upstream.ok()) {
    keep = co_await SendText(request, http::status::bad_request,
                             absl::StrCat(upstream.status().message(), ".\n"));
  } else if (link_.Received().size() > 0) {
    unread_input_ = true;
    keep = co_await SendText(request, http::status::bad_request,
                             "Nothing may be sent before the upgrade is answered.\n");
  } else {
    // It says itself when the service works for it.
    link_.Begin(LinkUse::kReceiving);
    const auto exchange = std::make_shared<WebSocketExchange>(site_, link_.shared_from_this());
    co_await exchange->Run(request, *upstream);
  }
  co_return keep;
}

net::awaitable<bool> HttpConnection::AnswerPost(Parser& parser, const std::string& path) {
  const Request& request = parser.get();
  bool keep = false;
  // Calls look for no file, whose storage may hang.
  const bool is_call =
      IsMethodPath(path) && IsBinaryGrpcWeb(View(request[http::field::content_type]));
  if (is_call && request.version() < 11) {
    keep = co_await SendText(request, http::status::http_version_not_supported,
                             "Calls need HTTP/1.1, as responses are streamed in chunks.\n");
    co_return keep;
  }
  if (is_call) {
    keep = co_await AnswerCall(parser);
    co_return keep;
  }
  const absl::StatusOr<PageFile> page = co_await FindPageFile(request, path);
  if (!page.ok()) {
    keep = co_await SendStorageFails(request);
  } else if (path == "/healthz" || page->about.has_value()) {
    keep = co_await SendText(request, http::status::method_not_allowed,
                             "Read this path with GET.\n", kPageMethods);
  } else if (!IsMethodPath(path)) {
    keep = co_await SendText(request, http::status::not_found,
                             "There is nothing at this path; gRPC methods are at "
                             "/package.Service/Method.\n");
  } else {
    keep = co_await SendText(request, http::status::unsupported_media_type,
                             "Send calls as application/grpc-web or "
                             "application/grpc-web+proto; grpc-web-text, JSON and plain gRPC are "
                             "not supported on this port.\n");
  }
  co_return keep;
}

net::awaitable<bool> HttpConnection::AnswerOptions(const Request& request) {
  const std::string_view origin = View(request[http::field::origin]);
  if (!origin.empty() && !site_.policy.AllowsOrigin(origin)) {
    Tell(request, "Preflight", OriginNotAllowed());
    const std::string text =
        absl::StrCat("Pages of ", std::string(origin), " may not call this server; start it with ",
                     "--allow-origin ", std::string(origin), " to allow that.\n");
    const bool keep = co_await SendText(request, http::status::forbidden, text);
    co_return keep;
  }
  http::response<http::empty_body> response(http::status::no_content, request.version());
  response.set(http::field::allow, "GET, HEAD, POST, OPTIONS");
  if (!origin.empty()) {
    site_.policy.DecoratePreflight(View(request[http::field::access_control_request_headers]),
                                   response);
  }
  const bool keep = co_await Send(request, response);
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
    unread_input_ = false;
    link_.Begin(LinkUse::kCalling);
    keep = co_await GrpcWebExchange(site_, link_, request).Run();
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
  co_await http::async_read(link_.Stream(), link_.Received(), parser,
                            net::redirect_error(net::use_awaitable, error));
  link_.Begin(LinkUse::kSending);
  co_return error;
}

net::awaitable<bool> HttpConnection::RefuseLargeCall(const Request& request) {
  Tell(request, "Message", MessageTooLarge());
  const absl::Status status = absl::ResourceExhaustedError(
      absl::StrCat("the request message is larger than the ", site_.options.max_message_bytes,
                   " bytes that this server accepts"));
  GrpcWebExchange exchange(site_, link_, request);
  const bool keep = co_await exchange.Refuse(status, /*keep_alive=*/false);
  co_return keep;
}

net::awaitable<bool> HttpConnection::AnswerBadHeader(error_code error) {
  // No response if the client closed the connection, or after a timeout or network error.
  if (error.category() != http::make_error_code(http::error::bad_method).category() ||
      error == http::error::end_of_stream || error == http::error::partial_message) {
    co_return false;
  }
  unread_input_ = true;
  const bool too_large =
      error == http::error::header_limit || error == http::error::buffer_overflow;
  Request request;
  request.version(11);
  request.keep_alive(false);
  if (too_large) Tell(request, "Request", HeaderTooLarge());
  const bool keep = co_await SendText(
      request,
      too_large ? http::status::request_header_fields_too_large : http::status::bad_request,
      absl::StrCat("Cannot parse the request's header: ", error.message(), ".\n"));
  co_return keep;
}

net::awaitable<absl::StatusOr<PageFile>> HttpConnection::FindPageFile(const Request& request,
                                                                      const std::string& path) {
  if (site_.files->IsEmpty()) co_return PageFile();
  const auto found = std::make_shared<PageFile>();
  const bool is_read = request.method() != http::verb::post;
  // Named, as GCC 12 destroys some temporaries of a co_await twice.
  std::function<void()> find =
      [found, files = site_.files, path, closer = std::weak_ptr(site_.file_closer),
       accepted = std::string(View(request[http::field::accept_encoding])),
       known = std::string(View(request[http::field::if_none_match])), is_read] {
        found->about = files->Find(path, accepted);
        if (!found->about.has_value() || !is_read) return;
        if (MatchesEntityTag(known, found->about->entity_tag)) return;
        found->file = OpenFile::Open(found->about->path, closer);
      };
  const std::string owner = FilesOwnerOf(request);
  const absl::Status done = co_await site_.page_threads.Run(executor_, owner, std::move(find));
  if (!done.ok()) co_return done;
  co_return *found;
}

net::awaitable<bool> HttpConnection::SendFile(const Request& request, const PageFile& page) {
  const StaticFile& about = *page.about;
  http::response<http::empty_body> header(http::status::ok, request.version());
  header.set(http::field::etag, about.entity_tag);
  header.set(http::field::cache_control, about.cache_control);
  if (about.varies) header.set(http::field::vary, "Accept-Encoding");
  bool keep = false;
  if (MatchesEntityTag(View(request[http::field::if_none_match]), about.entity_tag)) {
    header.result(http::status::not_modified);
    keep = co_await Send(request, header);
    co_return keep;
  }
  if (!page.file.ok()) {
    spdlog::warn("{}", std::string(page.file.status().message()));
    keep = co_await SendText(request, http::status::not_found, "This file cannot be read.\n");
    co_return keep;
  }
  const std::shared_ptr<const OpenFile>& file = *page.file;
  header.set(http::field::content_type, about.content_type);
  if (!about.content_encoding.empty()) {
    header.set(http::field::content_encoding, about.content_encoding);
  }
  header.content_length(file->Bytes());
  FilePart all{site_.page_threads, about.path.string(), file, 0, file->Bytes()};
  keep = co_await SendPart(request, header, std::move(all));
  co_return keep;
}

net::awaitable<bool> HttpConnection::SendKept(const Request& request, const KeptFile& file) {
  bool keep = false;
  const std::string entity_tag = absl::StrCat("\"", file.entity_tag, "\"");
  if (MatchesEntityTag(View(request[http::field::if_none_match]), entity_tag)) {
    http::response<http::empty_body> header(http::status::not_modified, request.version());
    DescribeKept(entity_tag, header);
    keep = co_await Send(request, header);
    co_return keep;
  }
  const auto opened = std::make_shared<FileOr>(absl::NotFoundError("not opened"));
  std::function<void()> open = [opened, path = file.path,
                                closer = std::weak_ptr(site_.file_closer)] {
    *opened = OpenFile::Open(path, closer);
  };
  const std::string owner = FilesOwnerOf(request);
  const absl::Status done = co_await site_.kept_threads.Run(executor_, owner, std::move(open));
  if (!done.ok()) {
    keep = co_await SendStorageFails(request);
  } else if (!opened->ok()) {
    keep = co_await SendText(request, http::status::not_found, "This file is gone.\n");
  } else {
    std::shared_ptr<const OpenFile> result = **opened;
    keep = co_await SendKeptPart(request, file, std::move(result));
  }
  co_return keep;
}

net::awaitable<bool> HttpConnection::SendKeptPart(const Request& request, const KeptFile& file,
                                                  std::shared_ptr<const OpenFile> opened) {
  http::response<http::empty_body> header(http::status::ok, request.version());
  const std::string entity_tag = absl::StrCat("\"", file.entity_tag, "\"");
  DescribeKept(entity_tag, header);
  // All is sent if the contents are not those that the client has a part of. Only GET has parts.
  const std::string_view only_if = View(request[http::field::if_range]);
  const bool may_be_part =
      request.method() == http::verb::get && (only_if.empty() || only_if == entity_tag);
  const ByteRange range =
      RangeOf(may_be_part ? View(request[http::field::range]) : "", opened->Bytes());
  bool keep = false;
  if (range.asked == ByteRange::Asked::kNothingThere) {
    header.result(http::status::range_not_satisfiable);
    header.set(http::field::content_range, absl::StrCat("bytes */", opened->Bytes()));
    header.content_length(0);
    keep = co_await Send(request, header);
    co_return keep;
  }
  if (range.asked == ByteRange::Asked::kPart) {
    header.result(http::status::partial_content);
    header.set(http::field::content_range,
               absl::StrCat("bytes ", range.first, "-", range.first + range.bytes - 1, "/",
                            opened->Bytes()));
  }
  header.set(http::field::content_type, PictureTypeOf(file.path));
  header.content_length(range.bytes);
  const std::uint64_t file_bytes = opened->Bytes();
  FilePart part{site_.kept_threads, file.path, std::move(opened), range.first, range.bytes};
  keep = co_await SendPart(request, header, std::move(part));
  const bool to_its_end =
      request.method() == http::verb::get && range.first + range.bytes == file_bytes;
  if (sent_whole_ && to_its_end && file.on_sent != nullptr) file.on_sent();
  co_return keep;
}

net::awaitable<bool> HttpConnection::SendPart(const Request& request,
                                              http::response<http::empty_body>& header,
                                              FilePart part) {
  const bool keep = Complete(request, header);
  const auto end = EndOfSending(part.bytes);
  std::ostringstream text;
  text << header.base();
  // Goes with the first of the file.
  std::string unsent_header = text.str();
  if (request.method() == http::verb::head) part.bytes = 0;
  sent_whole_ = false;
  // Owned by the thread that reads, too, as it may hang.
  struct Read {
    std::vector<char> into = std::vector<char>(kFilePart);
    std::ptrdiff_t bytes = 0;
    std::string error;
  };
  const auto read = std::make_shared<Read>();
  const std::string owner = FilesOwnerOf(request);
  do {
    if (part.bytes > 0) {
      const auto most = static_cast<size_t>(std::min<std::uint64_t>(part.bytes, kFilePart));
      std::function<void()> work = [read, file = part.file, first = part.first, most] {
        read->bytes = file->Read(first, read->into.data(), most);
        if (read->bytes < 0) read->error = strerror(errno);
        if (read->bytes == 0) read->error = "it has become shorter";
      };
      const absl::Status done = co_await part.threads.Run(executor_, owner, std::move(work));
      if (!done.ok() || read->bytes <= 0) {
        LogFailedRead(part.path, done.ok() ? absl::UnavailableError(read->error) : done);
        if (unsent_header.empty()) co_return false;
        const bool keep_refused = co_await SendStorageFails(request);
        sent_whole_ = false;
        co_return keep_refused;
      }
    }
    const auto bytes = static_cast<size_t>(read->bytes);
    // TLS writes the first buffer by itself if all are too many bytes, and nothing if it is empty.
    std::vector<net::const_buffer> buffers;
    if (!unsent_header.empty()) buffers.push_back(net::buffer(unsent_header));
    buffers.push_back(net::buffer(read->into.data(), bytes));
    const bool written = co_await link_.WriteAll(std::move(buffers), end);
    if (!written) co_return false;
    unsent_header.clear();
    part.first += bytes;
    part.bytes -= bytes;
  } while (part.bytes > 0);
  sent_whole_ = true;
  co_return keep;
}

net::awaitable<bool> HttpConnection::SendStorageFails(const Request& request) {
  const bool keep =
      co_await SendText(request, http::status::service_unavailable,
                        "The storage of this file does not answer; try again later.\n");
  co_return keep;
}

void HttpConnection::LogFailedRead(const std::string& path, const absl::Status& why) {
  if (absl::IsCancelled(why)) return;
  const auto left_out = site_.failed_reads.Take(std::chrono::system_clock::now());
  if (!left_out.has_value()) return;
  spdlog::warn("cannot read {}: {} ({} more since the last line)", path, std::string(why.message()),
               *left_out);
}

net::awaitable<bool> HttpConnection::SendText(const Request& request, http::status status,
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
  keep = co_await Send(request, response);
  co_return keep;
}

template <typename Body>
net::awaitable<bool> HttpConnection::Send(const Request& request, http::response<Body>& response) {
  const bool keep_alive = Complete(request, response);
  http::response_serializer<Body> serializer(response);
  sent_whole_ = false;
  const auto end = EndOfSending(response.payload_size().value_or(0));
  // In parts, so that it also times out without any progress.
  while (!serializer.is_done()) {
    link_.ExpireIdleWrite(end);
    error_code error;
    co_await http::async_write_some(link_.Stream(), serializer,
                                    net::redirect_error(net::use_awaitable, error));
    if (error) co_return false;
  }
  sent_whole_ = true;
  co_return keep_alive;
}

template <typename Body>
bool HttpConnection::Complete(const Request& request, http::response<Body>& response) {
  const bool keep_alive = request.keep_alive() && !unread_input_;
  site_.policy.Decorate(View(request[http::field::origin]), response);
  response.keep_alive(keep_alive);
  link_.Begin(LinkUse::kSending);
  return keep_alive;
}

ClientLink::Clock::time_point HttpConnection::EndOfSending(std::uint64_t bytes) const {
  return ClientLink::Clock::now() + site_.options.DeliveryTime(bytes);
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
