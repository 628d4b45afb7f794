// One client's TCP connection: writes that time out only when they make no progress, and detection
// of a client that disconnects while its call is idle. Knows neither HTTP nor gRPC. Runs on one
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
  // Bytes that were read but not yet parsed.
  boost::beast::flat_buffer& Received() { return received_; }

  void ExpireIdleWrite() { stream_.expires_after(write_stall_timeout_); }
  // False if the client is gone or accepted nothing for the stall timeout.
  boost::asio::awaitable<bool> WriteAll(std::vector<boost::asio::const_buffer> buffers);

  // Calls `on_gone` once if the client closes or half-closes its side before StopWatching(). Bytes
  // that it sends meanwhile are kept in Received(), up to a limit beyond which it counts as gone
  // too.
  void StartWatching(std::function<void()> on_gone);
  boost::asio::awaitable<void> StopWatching();
  bool Gone() const { return gone_; }

  // Closes the sending side and waits briefly for the client to close its own, so that a client
  // still sending reads the response instead of a connection reset.
  boost::asio::awaitable<void> LingeringClose();
  // Closes at once; pending operations on the link fail.
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
