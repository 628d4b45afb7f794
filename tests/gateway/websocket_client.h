// A WebSocket client for tests. Of grpc-websocket.v1 it knows only the subprotocol's name. It
// reads, and answers pings and closing, only within Receive() and similar functions. A wait that
// exceeds testing::kHangLimit throws an exception.
#pragma once

#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <string>

#include "tests/gateway/raw_client.h"

namespace thunderhead::gateway::test {

class WebSocketClient {
 public:
  struct Options {
    std::string method = "Converse";
    Headers headers;
    // Limits the bytes that the kernel buffers for the client; 0: the kernel's own choice.
    int receive_buffer_bytes = 0;
  };

  // Connects and upgrades; throws if the server refuses.
  explicit WebSocketClient(uint16_t port) : WebSocketClient(port, Options()) {}
  WebSocketClient(uint16_t port, const Options& options);

  // Sends a whole binary message.
  void Send(const std::string& message);
  // Sends a message while Receive() runs.
  void SendLater(const std::string& message);
  void SendText(const std::string& message);
  // Sends a message repeatedly until the server accepts none, even after it has handled other work,
  // which `elsewhere` causes. Returns how many it accepted.
  int SendUntilHeldBack(const std::string& message, int most,
                        const std::function<void()>& elsewhere);
  // Returns the next message. Returns nothing if the connection has ended; CloseCode() then returns
  // its close code.
  std::optional<std::string> Receive();
  // Reads all messages until the connection ends.
  std::deque<std::string> ReceiveAll();
  // Returns the server's close code; 1006 if the connection ended without one.
  int CloseCode();
  std::string CloseText();

  // Closes the WebSocket with the closing handshake.
  void Close();
  // Closes the connection without a closing handshake.
  void Vanish() { socket_.next_layer().close(); }
  // Returns true if the connection ends within the wait, although this client answers nothing.
  bool IsCut();

  // Returns the number of pings that were answered. It may be called from any thread.
  int PingsAnswered() const { return pings_answered_; }
  // Returns the number of bytes that the kernel buffers for this client.
  int UnreadBytes();
  // Returns true if the kernel has acknowledged everything that the gateway has sent, which it does
  // up to 200 ms later. Needs a gateway in this process.
  bool HasAcknowledged();
  // Returns true if the server has ended the connection.
  bool HasHungUp();

 private:
  template <typename Done>
  void RunUntil(const Done& done);
  void WriteNext();

  boost::asio::io_context io_;
  boost::beast::websocket::stream<boost::beast::tcp_stream, /*deflateSupported=*/false> socket_;
  boost::beast::flat_buffer received_;
  std::deque<std::string> unsent_;
  bool is_writing_ = false;
  bool has_ended_ = false;
  std::atomic<int> pings_answered_{0};
};

}  // namespace thunderhead::gateway::test
