// One client's TCP connection: writes that time out only when they make no progress, detection of a
// client that disconnects while its call is idle, and how many bytes went each way. Knows neither
// HTTP nor gRPC. Runs on one thread.
#pragma once

#include <boost/asio/buffer.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/basic_stream.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/rate_policy.hpp>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <vector>

#include "gateway/awaitable.h"
#include "gateway/change_signal.h"

namespace thunderhead::gateway {

// Beast's hook for rate limits, which counts the bytes of a stream and limits nothing.
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

using ClientStream =
    boost::beast::basic_stream<boost::asio::ip::tcp, boost::asio::any_io_executor, ByteCounts>;

class ClientLink : public std::enable_shared_from_this<ClientLink> {
 public:
  ClientLink(boost::asio::ip::tcp::socket socket, std::chrono::milliseconds write_stall_timeout);

  // The stream, for requests read through `Received()` and for responses; call ExpireIdleWrite()
  // before each write.
  ClientStream& Stream() { return stream_; }
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

  // Bytes read from the client; bytes that the kernel took for it; of these, bytes that its machine
  // acknowledged.
  uint64_t ReceivedBytes() { return stream_.rate_policy().Received(); }
  uint64_t SentBytes() { return stream_.rate_policy().Sent(); }
  uint64_t DeliveredBytes();
  // True if the client closed its side or the connection broke, also while nothing is read.
  bool HasHungUp();

  // Closes the sending side and waits briefly for the client to close its own, so that a client
  // still sending reads the response instead of a connection reset.
  boost::asio::awaitable<void> LingeringClose();
  // Closes at once; pending operations on the link fail.
  void Close();

  // Stop() calls `farewell`, which must see to an early Close(), instead of closing; an empty one
  // removes it.
  void SetFarewell(std::function<void()> farewell) { farewell_ = std::move(farewell); }
  // The gateway is going away.
  void Stop();

 private:
  void WatchOn();
  void OnWatched(boost::system::error_code error, size_t bytes);

  ClientStream stream_;
  boost::beast::flat_buffer received_;
  std::chrono::milliseconds write_stall_timeout_;
  ChangeSignal watch_changed_;
  std::function<void()> on_gone_;  // empty unless watching
  std::function<void()> farewell_;
  bool at_rest_ = true;  // the watch has no read pending
  bool gone_ = false;
};

}  // namespace thunderhead::gateway
