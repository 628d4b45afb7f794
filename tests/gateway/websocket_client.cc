#include "tests/gateway/websocket_client.h"

#include <linux/sockios.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include <boost/asio/post.hpp>
#include <boost/beast/core/buffers_to_string.hpp>
#include <chrono>
#include <stdexcept>

#include "absl/strings/str_cat.h"
#include "tests/support/wait_for.h"

namespace thunderhead::gateway::test {
namespace {

namespace net = boost::asio;
namespace websocket = boost::beast::websocket;
using boost::system::error_code;
using net::ip::tcp;

}  // namespace

WebSocketClient::WebSocketClient(uint16_t port, const Options& options) : socket_(io_) {
  tcp::socket& socket = socket_.next_layer().socket();
  socket.open(tcp::v4());
  if (options.receive_buffer_bytes > 0) {
    socket.set_option(net::socket_base::receive_buffer_size(options.receive_buffer_bytes));
  }
  socket.connect(tcp::endpoint(net::ip::address_v4::loopback(), port));
  socket.set_option(tcp::no_delay(true));
  socket_.set_option(
      websocket::stream_base::decorator([&options](websocket::request_type& request) {
        request.set("Sec-WebSocket-Protocol", "grpc-websocket.v1");
        for (const auto& [name, value] : options.headers) request.set(name, value);
      }));
  socket_.control_callback([this](websocket::frame_type kind, boost::beast::string_view) {
    // Posted work runs after the answer is sent.
    if (kind == websocket::frame_type::ping) net::post(io_, [this] { ++pings_answered_; });
  });
  socket_.read_message_max(0);
  socket_.binary(true);
  websocket::response_type response;
  socket_.handshake(response, absl::StrCat("localhost:", port),
                    absl::StrCat("/thunderhead.gateway.test.Echo/", options.method));
  if (response["Sec-WebSocket-Protocol"] != "grpc-websocket.v1") {
    throw std::runtime_error("the server did not choose the subprotocol");
  }
}

template <typename Done>
void WebSocketClient::RunUntil(const Done& done) {
  const auto patience = std::chrono::steady_clock::now() + testing::kHangLimit;
  io_.restart();
  while (!done()) {
    if (io_.stopped()) io_.restart();
    if (io_.run_one_until(patience) == 0 && std::chrono::steady_clock::now() >= patience) {
      socket_.next_layer().close();
      throw std::runtime_error("the server did not answer in time");
    }
  }
}

void WebSocketClient::Send(const std::string& message) {
  SendLater(message);
  RunUntil([this] { return !is_writing_; });
}

void WebSocketClient::SendLater(const std::string& message) {
  unsent_.push_back(message);
  if (!is_writing_) WriteNext();
}

void WebSocketClient::WriteNext() {
  is_writing_ = !unsent_.empty();
  if (!is_writing_) return;
  socket_.async_write(net::buffer(unsent_.front()), [this](error_code error, size_t) {
    unsent_.pop_front();
    if (error) unsent_.clear();
    WriteNext();
  });
}

void WebSocketClient::SendText(const std::string& message) {
  socket_.text(true);
  Send(message);
  socket_.binary(true);
}

int WebSocketClient::SendUntilHeldBack(const std::string& message, int most,
                                       const std::function<void()>& elsewhere) {
  constexpr int kTurns = 50;
  for (int sent = 0; sent < most; ++sent) {
    SendLater(message);
    for (int turn = 0; is_writing_ && turn < kTurns; ++turn) {
      io_.restart();
      io_.poll();
      if (is_writing_) elsewhere();
    }
    if (is_writing_) return sent;
  }
  return most;
}

std::optional<std::string> WebSocketClient::Receive() {
  if (has_ended_) return std::nullopt;
  bool done = false;
  received_.clear();
  socket_.async_read(received_, [&](error_code error, size_t) {
    done = true;
    has_ended_ = !!error;
  });
  RunUntil([&] { return done; });
  if (has_ended_) return std::nullopt;
  return boost::beast::buffers_to_string(received_.data());
}

std::deque<std::string> WebSocketClient::ReceiveAll() {
  std::deque<std::string> all;
  while (std::optional<std::string> message = Receive()) all.push_back(*std::move(message));
  return all;
}

int WebSocketClient::CloseCode() {
  ReceiveAll();
  const int code = socket_.reason().code;
  return code == websocket::close_code::none ? websocket::close_code::abnormal : code;
}

std::string WebSocketClient::CloseText() {
  ReceiveAll();
  return socket_.reason().reason.c_str();
}

void WebSocketClient::Close() {
  bool done = false;
  socket_.async_close(websocket::close_code::normal, [&](error_code) { done = true; });
  RunUntil([&] { return done; });
  has_ended_ = true;
}

int WebSocketClient::UnreadBytes() {
  int bytes = 0;
  ::ioctl(socket_.next_layer().socket().native_handle(), FIONREAD, &bytes);
  return bytes;
}

bool WebSocketClient::HasAcknowledged() {
  constexpr int kMostDescriptors = 1024;
  const uint16_t port = socket_.next_layer().socket().local_endpoint().port();
  // The gateway's socket is the one whose peer is this client.
  for (int descriptor = 0; descriptor < kMostDescriptors; ++descriptor) {
    sockaddr_in peer{};
    socklen_t size = sizeof(peer);
    if (::getpeername(descriptor, reinterpret_cast<sockaddr*>(&peer), &size) != 0) continue;
    if (peer.sin_family != AF_INET || ntohs(peer.sin_port) != port) continue;
    int unacknowledged = 0;
    return ::ioctl(descriptor, SIOCOUTQ, &unacknowledged) == 0 && unacknowledged == 0;
  }
  return true;  // the gateway has closed it
}

bool WebSocketClient::HasHungUp() {
  pollfd state = {socket_.next_layer().socket().native_handle(), POLLRDHUP, 0};
  return ::poll(&state, 1, 0) == 1;
}

bool WebSocketClient::IsCut() {
  std::string ignored(64 << 10, '\0');
  bool ended = false;
  while (!ended) {
    bool done = false;
    socket_.next_layer().async_read_some(net::buffer(ignored), [&](error_code error, size_t) {
      done = true;
      ended = !!error;
    });
    RunUntil([&] { return done; });
  }
  return ended;
}

}  // namespace thunderhead::gateway::test
