#include "tests/gateway/raw_client.h"

#include <poll.h>
#include <sys/socket.h>

#include <boost/asio/connect.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/read.hpp>
#include <limits>
#include <stdexcept>

#include "absl/strings/str_cat.h"
#include "tests/support/wait_for.h"

namespace thunderhead::gateway::test {
namespace {

namespace net = boost::asio;
namespace http = boost::beast::http;
using boost::system::error_code;
using net::ip::tcp;

void ThrowOn(const error_code& error, const char* what) {
  if (error) throw std::runtime_error(absl::StrCat(what, ": ", error.message()));
}

uint32_t FrameSize(const std::string& body, size_t at) {
  uint32_t size = 0;
  for (size_t i = 1; i < 5; ++i) size = size << 8 | static_cast<uint8_t>(body.at(at + i));
  return size;
}

void ParseTrailers(const std::string& lines, CallResult& result) {
  for (size_t begin = 0; begin < lines.size();) {
    const size_t end = lines.find("\r\n", begin);
    const size_t colon = lines.find(':', begin);
    if (end == std::string::npos || colon > end) throw std::runtime_error("bad trailers: " + lines);
    result.trailers.emplace(lines.substr(begin, colon - begin),
                            lines.substr(colon + 1, end - colon - 1));
    begin = end + 2;
  }
}

}  // namespace

RawClient::RawClient(uint16_t port, int receive_buffer_bytes) : stream_(io_) {
  tcp::socket& socket = stream_.socket();
  socket.open(tcp::v4());
  if (receive_buffer_bytes > 0) {
    socket.set_option(net::socket_base::receive_buffer_size(receive_buffer_bytes));
  }
  socket.connect(tcp::endpoint(net::ip::address_v4::loopback(), port));
}

template <typename Start>
error_code RawClient::Await(Start start) {
  error_code result;
  stream_.expires_after(testing::kHangLimit);
  start([&result](error_code error, size_t) { result = error; });
  io_.restart();
  io_.run();
  return result;
}

boost::system::error_code RawClient::Write(const std::string& bytes) {
  return Await(
      [&](auto handler) { net::async_write(stream_, net::buffer(bytes), std::move(handler)); });
}

void RawClient::Send(const std::string& bytes) { ThrowOn(Write(bytes), "sending"); }

bool RawClient::SendUntilClosed(const std::string& bytes) {
  const boost::system::error_code error = Write(bytes);
  if (error == net::error::broken_pipe || error == net::error::connection_reset) return false;
  ThrowOn(error, "sending");
  return true;
}

Response RawClient::Read(bool to_head) {
  Parser parser;
  parser.skip(to_head);
  parser.body_limit(std::numeric_limits<uint64_t>::max());
  ThrowOn(
      Await([&](auto handler) { http::async_read(stream_, buffer_, parser, std::move(handler)); }),
      "reading a response");
  return parser.release();
}

Response RawClient::Ask(const std::string& method, const std::string& target,
                        const Headers& headers, const std::string& body) {
  std::string request = absl::StrCat(method, " ", target, " HTTP/1.1\r\n");
  bool has_host = false;
  for (const auto& [name, value] : headers) {
    absl::StrAppend(&request, name, ": ", value, "\r\n");
    has_host = has_host || name == "Host";
  }
  if (!has_host) absl::StrAppend(&request, "Host: localhost\r\n");
  if (!body.empty()) absl::StrAppend(&request, "Content-Length: ", body.size(), "\r\n");
  absl::StrAppend(&request, "\r\n", body);
  Send(request);
  return Read(method == "HEAD");
}

Response RawClient::ReadHeaders() {
  parser_ = std::make_unique<Parser>();
  parser_->body_limit(std::numeric_limits<uint64_t>::max());
  ThrowOn(Await([&](auto handler) {
            http::async_read_header(stream_, buffer_, *parser_, std::move(handler));
          }),
          "reading headers");
  return parser_->get();
}

const std::string& RawClient::ReadBody(size_t bytes) {
  while (parser_->get().body().size() < bytes && !parser_->is_done()) {
    ThrowOn(Await([&](auto handler) {
              http::async_read_some(stream_, buffer_, *parser_, std::move(handler));
            }),
            "reading a body");
  }
  return parser_->get().body();
}

bool RawClient::IsClosed() {
  char byte = 0;
  const error_code error = Await(
      [&](auto handler) { stream_.async_read_some(net::buffer(&byte, 1), std::move(handler)); });
  return error == net::error::eof || error == net::error::connection_reset;
}

bool RawClient::IsEnded() {
  std::string ignored;
  const error_code error = ReadInto(&ignored);
  return error == net::error::eof || error == net::error::connection_reset;
}

std::string RawClient::ReadToEnd() {
  std::string all;
  ReadInto(&all);
  return all;
}

error_code RawClient::ReadInto(std::string* all) {
  char bytes[1024];
  error_code error;
  while (!error) {
    std::size_t count = 0;
    error = Await([&](auto handler) {
      stream_.async_read_some(net::buffer(bytes), [&count, handler](const error_code& outcome,
                                                                    std::size_t read) mutable {
        count = read;
        handler(outcome, read);
      });
    });
    all->append(bytes, count);
  }
  return error;
}

bool RawClient::HasInput() {
  pollfd state = {stream_.socket().native_handle(), POLLIN, 0};
  return buffer_.size() > 0 || ::poll(&state, 1, 0) == 1;
}

void RawClient::SendNow(const std::string& bytes) {
  static_cast<void>(::send(stream_.socket().native_handle(), bytes.data(), bytes.size(),
                           MSG_DONTWAIT | MSG_NOSIGNAL));
}

void RawClient::ShutdownSending() { stream_.socket().shutdown(tcp::socket::shutdown_send); }

void RawClient::Close() { stream_.close(); }

std::string CallRequest(const std::string& method, const std::string& body,
                        const Headers& headers) {
  std::string request =
      absl::StrCat("POST /thunderhead.gateway.test.Echo/", method, " HTTP/1.1\r\n",
                   "Host: localhost\r\nContent-Type: application/grpc-web+proto\r\n",
                   "Content-Length: ", body.size(), "\r\n");
  for (const auto& [name, value] : headers) absl::StrAppend(&request, name, ": ", value, "\r\n");
  return absl::StrCat(request, "\r\n", body);
}

std::string Frame(const std::string& message, uint8_t flags) {
  const auto size = static_cast<uint32_t>(message.size());
  std::string frame(1, static_cast<char>(flags));
  for (const int shift : {24, 16, 8, 0}) frame += static_cast<char>(size >> shift);
  return frame + message;
}

std::string CallResult::Trailer(const std::string& name) const {
  const auto found = trailers.find(name);
  return found == trailers.end() ? "" : found->second;
}

CallResult ParseResult(const Response& response) {
  if (response.result() != http::status::ok) {
    throw std::runtime_error(absl::StrCat("HTTP status ", response.result_int()));
  }
  CallResult result;
  const std::string& body = response.body();
  if (body.empty()) {
    result.trailers_only = true;
    for (const auto& field : response) {
      result.trailers.emplace(field.name_string().to_string(), field.value().to_string());
    }
  }
  for (size_t at = 0; at < body.size();) {
    const uint32_t size = FrameSize(body, at);
    const std::string content = body.substr(at + 5, size);
    if (content.size() != size) throw std::runtime_error("a frame is cut short");
    if ((static_cast<uint8_t>(body[at]) & 0x80) != 0) {
      ParseTrailers(content, result);
    } else {
      result.messages.push_back(content);
    }
    at += 5 + size;
  }
  return result;
}

CallResult Call(uint16_t port, const std::string& method, const std::string& message,
                const Headers& headers) {
  RawClient client(port);
  client.Send(CallRequest(method, Frame(message), headers));
  return ParseResult(client.Read());
}

}  // namespace thunderhead::gateway::test
