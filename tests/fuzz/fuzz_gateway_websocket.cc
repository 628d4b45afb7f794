// Fuzzes the bytes that a client sends after the upgrade to a WebSocket, with a live gateway and a
// live service behind it. Frames are complete, truncated, wrongly masked, fragmented or too long,
// with any messages. The connection must end once the client has sent everything, and the gateway
// must answer the next one.
#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdint>
#include <memory>
#include <string>

#include "spdlog/spdlog.h"
#include "tests/fuzz/must.h"
#include "tests/fuzz/websocket_bytes.h"
#include "tests/gateway/echo_service.h"

namespace thunderhead::gateway {
namespace {

// The timeout is long enough even if many processes compete with this one.
constexpr int kPatience_ms = 600'000;

using fuzz::Must;

std::uint16_t Port() {
  static const std::unique_ptr<test::EchoSite> site = [] {
    spdlog::set_level(spdlog::level::off);
    return test::EchoSite::Start({.max_message_bytes = 1u << 16});
  }();
  return site->Port();
}

class Socket {
 public:
  Socket() : socket_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(Port());
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    Must(connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0);
    // Closes the socket at once, so that no port stays reserved for bytes in flight.
    const linger at_once{1, 0};
    setsockopt(socket_, SOL_SOCKET, SO_LINGER, &at_once, sizeof(at_once));
  }
  ~Socket() { close(socket_); }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;

  // Sends the bytes, unless the server closes the connection before.
  void Send(const std::string& bytes) {
    for (std::size_t sent = 0; sent < bytes.size();) {
      const ssize_t now = send(socket_, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
      if (now <= 0) return;
      sent += static_cast<std::size_t>(now);
    }
  }
  void SendNoMore() { shutdown(socket_, SHUT_WR); }

  // Returns all bytes received until `end` has arrived or the server has closed.
  std::string Read(const std::string& end) {
    std::string read;
    while (end.empty() || read.find(end) == std::string::npos) {
      pollfd ready{socket_, POLLIN, 0};
      Must(poll(&ready, 1, kPatience_ms) == 1);  // fails if there is neither an answer nor an end
      char part[4096];
      const ssize_t now = recv(socket_, part, sizeof(part), 0);
      if (now <= 0) break;
      read.append(part, static_cast<std::size_t>(now));
    }
    return read;
  }

 private:
  const int socket_;
};

}  // namespace
}  // namespace thunderhead::gateway

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace thunderhead::gateway;
  if (size == 0) return 0;
  Socket socket;
  socket.Send(
      "GET /thunderhead.gateway.test.Echo/Converse HTTP/1.1\r\nHost: localhost\r\nUpgrade: "
      "websocket\r\n"
      "Connection: Upgrade\r\nSec-WebSocket-Key: AQIDBAUGBwgJCgsMDQ4PEA==\r\n"
      "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Protocol: grpc-websocket.v1\r\n\r\n");
  Must(socket.Read("\r\n\r\n").starts_with("HTTP/1.1 101"));
  socket.Send(thunderhead::fuzz::WebSocketBytes(data, size));
  socket.SendNoMore();
  socket.Read("");
  return 0;
}
