// One client's TCP connection. A write times out only if it makes no progress. The link detects a
// client that disconnects while its call is idle, and counts the bytes in each direction. It is
// independent of HTTP and gRPC. Runs on one thread.
#pragma once

#include <algorithm>
#include <boost/asio/buffer.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/time_source.h"
#include "gateway/awaitable.h"
#include "gateway/change_signal.h"
#include "gateway/client_stream.h"

namespace thunderhead::gateway {

// The uses of a connection. At the maximum number of connections, OpenLinks closes one for a new
// connection: first one that waits or receives, then one that sends, never one with a call.
enum class LinkUse {
  kWaiting,    // waits for the first byte of a request
  kReceiving,  // receives the rest of a request
  kSending,    // sends a file or a text
  kCalling,    // the service processes its call
};

class ClientLink : public std::enable_shared_from_this<ClientLink> {
 public:
  using Clock = std::chrono::steady_clock;

  // If `tls` is null, the connection uses plain TCP. `time` must outlive the link.
  ClientLink(boost::asio::ip::tcp::socket socket, std::shared_ptr<boost::asio::ssl::context> tls,
             std::chrono::milliseconds write_stall_timeout, const base::TimeSource& time);

  // Returns the client's address with its port.
  const std::string& Peer() const { return peer_; }
  // Returns the client's network (base::NetworkOf), by which its connections are counted.
  const std::string& Network() const { return network_; }

  void Begin(LinkUse use) {
    use_ = use;
    used_since_ = time_.Now();
  }
  LinkUse Use() const { return use_; }
  Clock::time_point UsedSince() const { return used_since_; }

  // Returns the stream, for requests read through `Received()` and for responses. Call
  // ExpireIdleWrite() before each write.
  ClientStream& Stream() { return stream_; }
  // Returns the bytes that were read but not yet parsed.
  boost::beast::flat_buffer& Received() { return received_; }

  void ExpireIdleWrite() { stream_.expires_after(write_stall_timeout_); }
  // Sets the stall timeout, and the additional limit that the write must be complete by `end`.
  void ExpireIdleWrite(Clock::time_point end) {
    stream_.expires_at(std::min(end, time_.Now() + write_stall_timeout_));
  }
  // Writes all buffers. Returns false if the client has disconnected, has accepted nothing during
  // the stall timeout, or has not accepted all bytes by `end`.
  boost::asio::awaitable<bool> WriteAll(std::vector<boost::asio::const_buffer> buffers,
                                        Clock::time_point end);

  // Calls `on_gone` once if the client closes or half-closes its side before StopWatching(). Bytes
  // that the client sends meanwhile are kept in Received(). A client that sends more than
  // Received() may hold counts as disconnected too.
  void StartWatching(std::function<void()> on_gone);
  boost::asio::awaitable<void> StopWatching();
  bool Gone() const { return gone_; }

  // These functions return the number of bytes that were received from the client (ReceivedBytes),
  // accepted by the kernel for sending (SentBytes), and acknowledged by the client's machine
  // (DeliveredBytes).
  uint64_t ReceivedBytes() { return stream_.Counts().Received(); }
  uint64_t SentBytes() { return stream_.Counts().Sent(); }
  uint64_t DeliveredBytes();
  // Returns true if the client closed its side or the connection broke. It works even while nothing
  // is read.
  bool HasHungUp();

  // Closes the sending side and waits briefly for the client to close its side. Thus a client that
  // is still sending can read the response, and does not get a connection reset.
  boost::asio::awaitable<void> LingeringClose();
  // Closes the connection at once. Pending operations on the link fail.
  void Close();

  // Sets a function that Stop() calls instead of closing the link. The function must ensure that
  // Close() follows soon. An empty function restores the default.
  void SetFarewell(std::function<void()> farewell) { farewell_ = std::move(farewell); }
  // Stops the link because the gateway shuts down.
  void Stop();

 private:
  void WatchOn();
  void OnWatched(boost::system::error_code error, size_t bytes);

  const base::TimeSource& time_;
  std::string peer_;
  std::string network_;
  LinkUse use_ = LinkUse::kWaiting;
  Clock::time_point used_since_ = time_.Now();
  ClientStream stream_;
  boost::beast::flat_buffer received_;
  std::chrono::milliseconds write_stall_timeout_;
  ChangeSignal watch_changed_;
  std::function<void()> on_gone_;  // empty while not watching
  std::function<void()> farewell_;
  bool at_rest_ = true;  // true while no read of the watch is pending
  bool gone_ = false;
};

}  // namespace thunderhead::gateway
