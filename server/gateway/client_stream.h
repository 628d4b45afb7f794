// An Asio stream over plain TCP or TLS for one client's connection. A deadline applies to the
// operations that begin after it was set. The stream counts the bytes in each direction. It is
// independent of HTTP and gRPC. Runs on one thread.
#pragma once

#include <boost/asio/associated_executor.hpp>
#include <boost/asio/buffer.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/beast/core/rate_policy.hpp>
#include <boost/beast/core/role.hpp>
#include <boost/beast/websocket/teardown.hpp>
#include <boost/system/error_code.hpp>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>

#include "base/time_source.h"
#include "gateway/awaitable.h"
#include "gateway/change_signal.h"
#include "gateway/stream_deadlines.h"
#include "streams/bytes_handler.h"
#include "streams/optional_tls.h"

namespace thunderhead::gateway {

// A rate policy for Beast's streams that counts bytes and limits nothing. With TLS, it counts
// encrypted bytes.
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

}  // namespace thunderhead::gateway

namespace thunderhead::streams {
extern template class OptionalTls<gateway::ByteCounts>;
}

namespace thunderhead::gateway {

class ClientStream : public streams::OptionalTls<ByteCounts> {
 public:
  // If `tls` is null, the stream uses plain TCP. `time` measures the deadlines and must outlive the
  // stream.
  ClientStream(boost::asio::ip::tcp::socket socket, std::shared_ptr<boost::asio::ssl::context> tls,
               const base::TimeSource& time);

  // Each function replaces the deadline for later reads and writes. If an operation is still
  // pending at its deadline, the socket is closed and the operation fails.
  void expires_after(base::TimeSource::Clock::duration timeout) {
    expires_at(time_.Now() + timeout);
  }
  void expires_at(base::TimeSource::Clock::time_point deadline) { deadlines_->Set(deadline); }
  void expires_never() { expires_at(base::TimeSource::Clock::time_point::max()); }

  // Performs the TLS handshake, which must be the first operation of a TLS stream. Returns false if
  // it fails.
  boost::asio::awaitable<bool> Handshake();

  const ByteCounts& Counts() { return PlainStream().rate_policy(); }

  using Take = std::function<bool(std::span<const std::byte>)>;

  // Passes the decrypted bytes of each later read to `take`. If `take` returns false, the read
  // fails. A null `take` ends this.
  void WatchReads(Take take) { *take_ = std::move(take); }

  // Sends `bytes` as the last data of the stream, after the write that is in progress. Later writes
  // succeed but are not sent. Returns false if the connection has ended.
  boost::asio::awaitable<bool> WriteLast(std::string bytes);

  // Closes the sending side. Then drops what the client still sends until the client closes its
  // side, the timeout expires or the socket is closed, and closes the socket. Closing a socket with
  // unread bytes immediately would reset the connection, and the client could lose the last data
  // sent to it.
  boost::asio::awaitable<void> LingeringClose();
  // Does the same as LingeringClose(), then calls `handler` without an error.
  void LingeringClose(streams::BytesHandler handler);

 private:
  void Read(streams::FewBuffers<boost::asio::mutable_buffer> into,
            streams::BytesHandler handler) override;
  void Write(streams::FewBuffers<boost::asio::const_buffer> from,
             streams::BytesHandler handler) override;

  const base::TimeSource& time_;
  const std::shared_ptr<StreamDeadlines> deadlines_;
  // The pointer is shared because a read may end after the stream was destroyed.
  const std::shared_ptr<Take> take_ = std::make_shared<Take>();
  bool between_writes_ = true;  // the last write has ended and was complete
  bool last_begun_ = false;
  ChangeSignal write_ended_;
};

// Functions that Beast calls to close the TCP connection when a WebSocket ends. Beast's own
// versions for sockets close the connection after the first bytes that they drop.
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
