// The bytes of one client's connection, plain or by TLS, to Asio and Beast a stream like any other:
// with one deadline for what is begun after it is set, and counts of what went each way. Knows
// neither HTTP nor gRPC. Runs on one thread.
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

}  // namespace thunderhead::gateway

namespace thunderhead::streams {
extern template class OptionalTls<gateway::ByteCounts>;
}

namespace thunderhead::gateway {

class ClientStream : public streams::OptionalTls<ByteCounts> {
 public:
  // `tls` null: plain. The deadlines are by `time`, which must outlive the stream.
  ClientStream(boost::asio::ip::tcp::socket socket, std::shared_ptr<boost::asio::ssl::context> tls,
               const base::TimeSource& time);

  // Each replaces the deadline of the reads and writes that begin from now on. The socket is closed
  // at the deadline of a pending one, which then fails.
  void expires_after(base::TimeSource::Clock::duration timeout) {
    expires_at(time_.Now() + timeout);
  }
  void expires_at(base::TimeSource::Clock::time_point deadline) { deadlines_->Set(deadline); }
  void expires_never() { expires_at(base::TimeSource::Clock::time_point::max()); }

  // The first of all where there is TLS. False if it fails.
  boost::asio::awaitable<bool> Handshake();

  const ByteCounts& Counts() { return PlainStream().rate_policy(); }

  using Take = std::function<bool(std::span<const std::byte>)>;

  // From now on `take` is given what each read brings, decrypted. The read fails if it returns
  // false. Null ends this.
  void WatchReads(Take take) { *take_ = std::move(take); }

  // Sends `bytes` after what is being sent, as the last of all: whatever is written later is taken
  // and not sent. False if the connection has ended.
  boost::asio::awaitable<bool> WriteLast(std::string bytes);

  // Says to the client that nothing more comes, and drops what it still sends until it ends too,
  // the timeout is over or the socket is closed; then closes it. A socket that is closed before its
  // bytes are read resets the connection, and the client may lose what was last sent to it.
  boost::asio::awaitable<void> LingeringClose();
  // The same; then calls `handler`, without an error.
  void LingeringClose(streams::BytesHandler handler);

 private:
  void Read(streams::FewBuffers<boost::asio::mutable_buffer> into,
            streams::BytesHandler handler) override;
  void Write(streams::FewBuffers<boost::asio::const_buffer> from,
             streams::BytesHandler handler) override;

  const base::TimeSource& time_;
  const std::shared_ptr<StreamDeadlines> deadlines_;
  // A read may end after the stream.
  const std::shared_ptr<Take> take_ = std::make_shared<Take>();
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
