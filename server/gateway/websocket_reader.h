// Reads a client's messages from a WebSocket, in the format of websocket_protocol.h. It first reads
// only the kind of each message, and its payload once the call can accept it. It is independent of
// calls and works on any byte stream.
#pragma once

#include <boost/asio/buffer.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/system/error_code.hpp>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "gateway/awaitable.h"
#include "gateway/websocket_protocol.h"

namespace thunderhead::gateway {

// A reader on a `Socket`, which is a boost::beast::websocket::stream. The socket must outlive the
// reader.
template <typename Socket>
class WebSocketReader {
 public:
  explicit WebSocketReader(Socket& socket) : socket_(socket) {}

  // Limits the size of a message's payload. Beast closes the connection of a client that sends a
  // larger message.
  void Limit(std::size_t max_message_bytes) {
    socket_.read_message_max(max_message_bytes + sizeof(kind_));
  }

  // Waits for the next message and reads only its kind (its first byte), so that flow control
  // applies to the rest. Returns an error if the connection has ended.
  boost::asio::awaitable<boost::system::error_code> ReadStart();
  // Describes the start of the message whose kind was read last.
  MessageStart Start() const {
    return {socket_.got_text(), has_kind_ ? std::optional<uint8_t>(kind_) : std::nullopt,
            !socket_.is_message_done(), half_closed_};
  }
  bool IsHalfClose() const { return has_kind_ && kind_ == kHalfCloseKind; }
  // Reads the rest of the current message.
  boost::asio::awaitable<boost::system::error_code> ReadPayload(boost::beast::flat_buffer& payload);

 private:
  Socket& socket_;
  bool has_kind_ = false;
  uint8_t kind_ = 0;
  bool half_closed_ = false;
};

template <typename Socket>
boost::asio::awaitable<boost::system::error_code> WebSocketReader<Socket>::ReadStart() {
  half_closed_ = half_closed_ || IsHalfClose();
  has_kind_ = false;
  boost::system::error_code error;
  do {
    const std::size_t bytes = co_await socket_.async_read_some(
        boost::asio::mutable_buffer(&kind_, sizeof(kind_)),
        boost::asio::redirect_error(boost::asio::use_awaitable, error));
    if (error) co_return error;
    has_kind_ = bytes > 0;
  } while (!has_kind_ && !socket_.is_message_done());
  co_return error;
}

template <typename Socket>
boost::asio::awaitable<boost::system::error_code> WebSocketReader<Socket>::ReadPayload(
    boost::beast::flat_buffer& payload) {
  boost::system::error_code error;
  if (!socket_.is_message_done()) {
    co_await socket_.async_read(payload,
                                boost::asio::redirect_error(boost::asio::use_awaitable, error));
  }
  co_return error;
}

}  // namespace thunderhead::gateway
