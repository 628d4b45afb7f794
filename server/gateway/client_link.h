// One client's TCP connection: writes that time out only when they make no progress, detection of a
// client that disconnects while its call is idle, and how many bytes went each way. Knows neither
// HTTP nor gRPC. Runs on one thread.
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

// Uses of a connection, in the order in which connections make room for new ones.
enum class LinkUse {
  kWaiting,    // for a request's first byte
  kReceiving,  // the rest of a request
  kSending,    // a file or text
  kCalling,    // the service works for it
};

class ClientLink : public std::enable_shared_from_this<ClientLink> {
 public:
  using Clock = std::chrono::steady_clock;

  // `tls` null: a plain connection. `time` must outlive the link.
  ClientLink(boost::asio::ip::tcp::socket socket, std::shared_ptr<boost::asio::ssl::context> tls,
             std::chrono::milliseconds write_stall_timeout, const base::TimeSource& time);

  // The client's address with its port.
  const std::string& Peer() const { return peer_; }
  // The client's network (base::NetworkOf), by which its connections are counted.
  const std::string& Network() const { return network_; }

  void Begin(LinkUse use) {
    use_ = use;
    used_since_ = time_.Now();
  }
  LinkUse Use() const { return use_; }
  Clock::time_point UsedSince() const { return used_since_; }

  // The stream, for requests read through `Received()` and for responses; call ExpireIdleWrite()
  // before each write.
  ClientStream& Stream() { return stream_; }
  // Bytes that were read but not yet parsed.
  boost::beast::flat_buffer& Received() { return received_; }

  void ExpireIdleWrite() { stream_.expires_after(write_stall_timeout_); }
  // The same where all must be written by `end`.
  void ExpireIdleWrite(Clock::time_point end) {
    stream_.expires_at(std::min(end, time_.Now() + write_stall_timeout_));
  }
  // False if the client is gone, accepted nothing for the stall timeout, or not all by `end`.
  boost::asio::awaitable<bool> WriteAll(std::vector<boost::asio::const_buffer> buffers,
                                        Clock::time_point end);

  // Calls `on_gone` once if the client closes or half-closes its side before StopWatching(). Bytes
  // that it sends meanwhile are kept in Received(), up to a limit beyond which it counts as gone
  // too.
  void StartWatching(std::function<void()> on_gone);
  boost::asio::awaitable<void> StopWatching();
  bool Gone() const { return gone_; }

  // Bytes read from the client; bytes that the kernel took for it; of these, bytes that its machine
  // acknowledged.
  uint64_t ReceivedBytes() { return stream_.Counts().Received(); }
  uint64_t SentBytes() { return stream_.Counts().Sent(); }
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

  const base::TimeSource& time_;
  std::string peer_;
  std::string network_;
  LinkUse use_ = LinkUse::kWaiting;
  Clock::time_point used_since_ = time_.Now();
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
