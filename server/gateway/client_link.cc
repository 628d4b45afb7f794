#include "gateway/client_link.h"

#include <linux/sockios.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include <boost/beast/core/buffers_suffix.hpp>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/client_network.h"

namespace thunderhead::gateway {
namespace {

namespace net = boost::asio;
using boost::system::error_code;

constexpr size_t kMaxReceived = 64 << 10;
constexpr size_t kWatchRead = 4 << 10;
constexpr std::chrono::seconds kLinger{2};

void SetOption(int socket, int level, int name, int value) {
  // The options are only improvements, so it does not matter if the kernel lacks one.
  static_cast<void>(::setsockopt(socket, level, name, &value, sizeof(value)));
}

void TuneSocket(int socket) {
  SetOption(socket, IPPROTO_TCP, TCP_NODELAY, 1);
  // The keepalive detects within about a minute that a client has disappeared without closing the
  // connection, even while its stream is idle.
  SetOption(socket, SOL_SOCKET, SO_KEEPALIVE, 1);
  SetOption(socket, IPPROTO_TCP, TCP_KEEPIDLE, 30);
  SetOption(socket, IPPROTO_TCP, TCP_KEEPINTVL, 10);
  SetOption(socket, IPPROTO_TCP, TCP_KEEPCNT, 3);
  // This limits how much data waits in the kernel for a slow client, because waiting frames only
  // add latency.
  SetOption(socket, IPPROTO_TCP, TCP_NOTSENT_LOWAT, 128 << 10);
}

}  // namespace

ClientLink::ClientLink(net::ip::tcp::socket socket, std::shared_ptr<net::ssl::context> tls,
                       std::chrono::milliseconds write_stall_timeout, const base::TimeSource& time)
    : time_(time),
      stream_(std::move(socket), std::move(tls), time),
      received_(kMaxReceived),
      write_stall_timeout_(write_stall_timeout),
      watch_changed_(stream_.get_executor()) {
  TuneSocket(stream_.socket().native_handle());
  // A client that has already disconnected has no endpoint, so an error is ignored.
  error_code error;
  const net::ip::tcp::endpoint endpoint = stream_.socket().remote_endpoint(error);
  const net::ip::address address = endpoint.address();
  peer_ = absl::StrCat(address.is_v6() ? "[" : "", address.to_string(), address.is_v6() ? "]" : "",
                       ":", endpoint.port());
  network_ = base::NetworkOf(peer_);
}

net::awaitable<bool> ClientLink::WriteAll(std::vector<net::const_buffer> buffers,
                                          Clock::time_point end) {
  boost::beast::buffers_suffix<std::vector<net::const_buffer>> rest(std::move(buffers));
  while (net::buffer_size(rest) > 0) {
    ExpireIdleWrite(end);
    error_code error;
    const size_t written =
        co_await stream_.async_write_some(rest, net::redirect_error(net::use_awaitable, error));
    if (error) co_return false;
    rest.consume(written);
  }
  co_return true;
}

void ClientLink::StartWatching(std::function<void()> on_gone) {
  on_gone_ = std::move(on_gone);
  WatchOn();
}

net::awaitable<void> ClientLink::StopWatching() {
  on_gone_ = nullptr;
  if (!at_rest_) stream_.cancel();
  co_await watch_changed_.AwaitTrue(at_rest_);
}

void ClientLink::WatchOn() {
  at_rest_ = false;
  stream_.expires_never();
  stream_.async_read_some(received_.prepare(kWatchRead),
                          [self = shared_from_this()](error_code error, size_t bytes) {
                            self->OnWatched(error, bytes);
                          });
}

void ClientLink::OnWatched(error_code error, size_t bytes) {
  received_.commit(bytes);
  at_rest_ = true;
  if (on_gone_ && !error && received_.size() + kWatchRead <= kMaxReceived) {
    WatchOn();
    return;
  }
  if (on_gone_) {
    gone_ = true;
    std::exchange(on_gone_, nullptr)();
  }
  watch_changed_.Notify();
}

uint64_t ClientLink::DeliveredBytes() {
  int unacknowledged = 0;
  if (::ioctl(stream_.socket().native_handle(), SIOCOUTQ, &unacknowledged) != 0) return SentBytes();
  return SentBytes() - static_cast<uint64_t>(unacknowledged);
}

bool ClientLink::HasHungUp() {
  pollfd state = {stream_.socket().native_handle(), POLLRDHUP, 0};
  return ::poll(&state, 1, 0) != 0;
}

net::awaitable<void> ClientLink::LingeringClose() {
  stream_.expires_after(kLinger);
  co_await stream_.LingeringClose();
}

void ClientLink::Close() {
  error_code ignored;
  stream_.socket().close(ignored);
}

void ClientLink::Stop() {
  if (farewell_) {
    farewell_();
  } else {
    Close();
  }
}

}  // namespace thunderhead::gateway
