// One client's TCP connection. Its writes time out only if they make no progress. It detects a
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

// Uses of a connection, in the order in which connections are closed to free a place for new ones.
enum class LinkUse {
  kWaiting,    // for the first byte of a request
  kReceiving,  // the rest of a request
  kSending,    // a file or a text
  kCalling,    // the service processes its call
};

class ClientLink : public std::enable_shared_from_this<ClientLink> {
 public:
  using Clock = std::chrono::steady_clock;

  // If `tls` is null, the connection is plain. `time` must outlive the link.
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
  // Sets the stall timeout, with the additional limit that all must be written by `end`.
  void ExpireIdleWrite(Clock::time_point end) {
    stream_.expires_at(std::min(end, time_.Now() + write_stall_timeout_));
  }
  // Writes all buffers. Returns false if the client has disconnected, accepted nothing during the
  // stall timeout, or did not accept all by `end`.
  boost::asio::awaitable<bool> WriteAll(std::vector<boost::asio::const_buffer> buffers,
                                        Clock::time_point end);

  // Calls `on_gone` once if the client closes or half-closes its side before StopWatching(). Bytes
  // that the client sends meanwhile are kept in Received(). A client that exceeds the limit of
  // Received() counts as disconnected too.
  void StartWatching(std::function<void()> on_gone);
  boost::asio::awaitable<void> StopWatching();
  bool Gone() const { return gone_; }

  // Returns the number of bytes that were received from the client, accepted by the kernel for
  // sending, and acknowledged by the client's machine.
  uint64_t ReceivedBytes() { return stream_.Counts().Received(); }
  uint64_t SentBytes() { return stream_.Counts().Sent(); }
  uint64_t DeliveredBytes();
  // Returns true if the client closed its side or the connection broke, even while nothing is read.
  bool HasHungUp();

  // Closes the sending side and waits briefly for the client to close its side. A client that is
  // still sending then reads the response instead of a connection reset.
  boost::asio::awaitable<void> LingeringClose();
  // Closes the connection at once. Pending operations on the link fail.
  void Close();

  // Sets a function that Stop() calls instead of closing. It must ensure that Close() follows soon.
  // An empty function removes it.
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
  bool at_rest_ = true;  // true while the watch has no pending read
  bool gone_ = false;
};

}  // namespace thunderhead::gateway
