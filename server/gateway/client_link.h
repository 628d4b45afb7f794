// One client's TCP connection: writes that give up only when nothing moves, and a watch that
// notices a client that leaves while its call is quiet. Knows neither HTTP nor gRPC. Runs on one
// thread.
#pragma once

#include <boost/asio/buffer.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <chrono>
#include <functional>
#include <memory>
#include <vector>

#include "gateway/awaitable.h"

namespace thunderhead::gateway {

class ClientLink : public std::enable_shared_from_this<ClientLink> {
 public:
  ClientLink(boost::asio::ip::tcp::socket socket, std::chrono::milliseconds write_stall_timeout);

  // The stream, for requests read through `Received()` and for responses; call ExpireIdleWrite()
  // before each write.
  boost::beast::tcp_stream& Stream() { return stream_; }
  // What has been read and not yet parsed.
  boost::beast::flat_buffer& Received() { return received_; }

  void ExpireIdleWrite() { stream_.expires_after(write_stall_timeout_); }
  // False where the client is gone or took nothing for the stall timeout.
  boost::asio::awaitable<bool> WriteAll(std::vector<boost::asio::const_buffer> buffers);

  // Calls `on_gone` once if the client closes or half closes its side before StopWatching(). What
  // it sends meanwhile is kept in Received(), up to a limit beyond which it counts as gone too.
  void StartWatching(std::function<void()> on_gone);
  boost::asio::awaitable<void> StopWatching();
  bool Gone() const { return gone_; }

  // Ends the sending side and waits a moment for the client's, so that a client still sending reads
  // the answer instead of a connection reset.
  boost::asio::awaitable<void> LingeringClose();
  // At once; everything under way on the link fails.
  void Close();

 private:
  void WatchOn();
  void OnWatched(boost::system::error_code error, size_t bytes);

  boost::beast::tcp_stream stream_;
  boost::beast::flat_buffer received_;
  std::chrono::milliseconds write_stall_timeout_;
  // Never expires: cancelled to wake StopWatching().
  boost::asio::steady_timer watch_ended_;
  std::function<void()> on_gone_;  // empty unless watching
  bool reading_ = false;
  bool gone_ = false;
};

}  // namespace thunderhead::gateway
