// The bytes of one client's connection, plain or by TLS, to Asio and Beast a stream like any other:
// with one timeout for what is begun after it is set, and counts of what went each way. Knows
// neither HTTP nor gRPC. Runs on one thread.
#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/async_result.hpp>
#include <boost/asio/buffer.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/asio/ssl/stream.hpp>
#include <boost/beast/core/basic_stream.hpp>
#include <boost/beast/core/flat_stream.hpp>
#include <boost/beast/core/rate_policy.hpp>
#include <boost/beast/core/role.hpp>
#include <boost/beast/websocket/teardown.hpp>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "gateway/awaitable.h"
#include "gateway/change_signal.h"
#include "streams/bytes_handler.h"

namespace thunderhead::gateway {

// Beast's hook for rate limits, which counts the bytes of a stream and limits nothing. By TLS they
// are encrypted.
class ByteCounts {
 public:
  uint64_t Received() const { return received_; }
  uint64_t Sent() const { return sent_; }

 private:
  friend class boost::beast::rate_policy_access;
  static constexpr size_t kUnlimited = std::numeric_limits<size_t>::max();

  size_t available_read_bytes() const { return kUnlimited; }
  size_t available_write_bytes() const { return kUnlimited; }
  void transfer_read_bytes(size_t bytes) { received_ += bytes; }
  void transfer_write_bytes(size_t bytes) { sent_ += bytes; }
  void on_timer() {}

  uint64_t received_ = 0;
  uint64_t sent_ = 0;
};

class ClientStream {
 public:
  // Asio's name for it.
  using executor_type = boost::asio::any_io_executor;

  // `tls` null: plain.
  ClientStream(boost::asio::ip::tcp::socket socket, std::shared_ptr<boost::asio::ssl::context> tls);

  // The first of all where there is TLS. False if it fails.
  boost::asio::awaitable<bool> Handshake();

  executor_type get_executor() { return plain_.get_executor(); }
  boost::asio::ip::tcp::socket& socket() { return plain_.socket(); }
  const ByteCounts& Counts() { return plain_.rate_policy(); }
  void expires_after(std::chrono::steady_clock::duration time) { plain_.expires_after(time); }
  void expires_at(std::chrono::steady_clock::time_point time) { plain_.expires_at(time); }
  void expires_never() { plain_.expires_never(); }
  void cancel() { plain_.cancel(); }

  // Sends `bytes` after what is being sent, as the last of all: whatever is written later is taken
  // and not sent. False if the connection has ended.
  boost::asio::awaitable<bool> WriteLast(std::string bytes);

  // Says to the client that nothing more comes, and drops what it still sends until it ends too,
  // the timeout is over or the socket is closed; then closes it. A socket that is closed before its
  // bytes are read resets the connection, and the client may lose what was last sent to it.
  boost::asio::awaitable<void> LingeringClose();
  // The same; then calls `handler`, without an error.
  void LingeringClose(streams::BytesHandler handler);

  template <typename Buffers, typename Token>
  auto async_read_some(const Buffers& buffers, Token&& token) {
    return boost::asio::async_initiate<Token, void(boost::system::error_code, size_t)>(
        [this](auto&& handler, const Buffers& into) {
          Read(into,
               streams::BytesHandler(std::forward<decltype(handler)>(handler), get_executor()));
        },
        token, buffers);
  }

  template <typename Buffers, typename Token>
  auto async_write_some(const Buffers& buffers, Token&& token) {
    return boost::asio::async_initiate<Token, void(boost::system::error_code, size_t)>(
        [this](auto&& handler, const Buffers& from) {
          Write(from,
                streams::BytesHandler(std::forward<decltype(handler)>(handler), get_executor()));
        },
        token, buffers);
  }

 private:
  using Plain = boost::beast::basic_stream<boost::asio::ip::tcp, executor_type, ByteCounts>;
  // Makes one TLS record of several small buffers.
  using Tls = boost::beast::flat_stream<boost::asio::ssl::stream<Plain&>>;

  void Read(streams::FewBuffers<boost::asio::mutable_buffer> into, streams::BytesHandler handler);
  void Write(streams::FewBuffers<boost::asio::const_buffer> from, streams::BytesHandler handler);
  void Send(streams::FewBuffers<boost::asio::const_buffer> from, streams::BytesHandler handler);

  const std::shared_ptr<boost::asio::ssl::context> context_;  // outlives what is made of it
  Plain plain_;
  std::optional<Tls> tls_;
  bool between_writes_ = true;  // the last one has ended, and was whole
  bool last_begun_ = false;
  ChangeSignal write_ended_;
};

// Beast's hooks for the end of a WebSocket: that of its TCP connection. Its own for sockets close
// after the first bytes that they drop.
void beast_close_socket(ClientStream& stream);
void teardown(boost::beast::role_type role, ClientStream& stream, boost::system::error_code& error);
template <typename Handler>
void async_teardown(boost::beast::role_type /*server*/, ClientStream& stream, Handler&& handler) {
  const auto executor = boost::asio::get_associated_executor(handler, stream.get_executor());
  stream.LingeringClose(streams::BytesHandler(
      [handler = std::forward<Handler>(handler)](boost::system::error_code error, size_t) mutable {
        std::move(handler)(error);
      },
      executor));
}

}  // namespace thunderhead::gateway
