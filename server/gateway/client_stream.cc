#include "gateway/client_stream.h"

#include <algorithm>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/error.hpp>
#include <boost/asio/post.hpp>
#include <exception>
#include <utility>

namespace thunderhead::streams {
template class OptionalTls<gateway::ByteCounts>;
}

namespace thunderhead::gateway {

namespace net = boost::asio;
using boost::system::error_code;

using Way = StreamDeadlines::Way;

namespace {

bool Takes(const ClientStream::Take& take, const streams::FewBuffers<net::mutable_buffer>& read,
           std::size_t bytes) {
  if (!take) return true;
  for (const net::mutable_buffer& buffer : read) {
    const std::size_t here = std::min(bytes, buffer.size());
    if (here > 0 && !take({static_cast<const std::byte*>(buffer.data()), here})) return false;
    bytes -= here;
  }
  return true;
}

}  // namespace

ClientStream::ClientStream(net::ip::tcp::socket socket, std::shared_ptr<net::ssl::context> tls,
                           const base::TimeSource& time)
    : OptionalTls(std::move(socket), std::move(tls)),
      time_(time),
      deadlines_(std::make_shared<StreamDeadlines>(OptionalTls::socket(), time)),
      write_ended_(get_executor()) {}

net::awaitable<bool> ClientStream::Handshake() {
  error_code error;
  if (auto* tls = TlsStream(); tls != nullptr) {
    deadlines_->Begin(Way::kRead);
    co_await tls->async_handshake(net::ssl::stream_base::server,
                                  net::redirect_error(net::use_awaitable, error));
    deadlines_->End(Way::kRead);
  }
  co_return !error;
}

net::awaitable<void> ClientStream::LingeringClose() {
  error_code error;
  socket().shutdown(net::ip::tcp::socket::shutdown_send, error);
  std::array<char, 16 << 10> ignored;
  deadlines_->Begin(Way::kRead);
  while (!error) {
    co_await PlainStream().async_read_some(net::buffer(ignored),
                                           net::redirect_error(net::use_awaitable, error));
  }
  deadlines_->End(Way::kRead);
  socket().close(error);
}

void ClientStream::LingeringClose(streams::BytesHandler handler) {
  const auto executor = handler.get_executor();
  net::co_spawn(executor, LingeringClose(),
                [handler = std::move(handler)](const std::exception_ptr&) mutable {
                  handler(error_code(), 0);
                });
}

void ClientStream::Read(streams::FewBuffers<net::mutable_buffer> into,
                        streams::BytesHandler handler) {
  deadlines_->Begin(Way::kRead);
  const auto executor = handler.get_executor();
  auto read = [take = take_, into, deadlines = deadlines_, handler = std::move(handler)](
                  error_code error, std::size_t bytes) mutable {
    deadlines->End(Way::kRead);
    if (!error && !Takes(*take, into, bytes)) {
      handler(net::error::connection_aborted, 0);
    } else {
      handler(error, bytes);
    }
  };
  OptionalTls::Read(into, streams::BytesHandler(std::move(read), executor));
}

void ClientStream::Write(streams::FewBuffers<net::const_buffer> from,
                         streams::BytesHandler handler) {
  const std::size_t bytes = net::buffer_size(from);
  const auto executor = handler.get_executor();
  if (last_begun_ && between_writes_) {
    net::post(executor,
              [handler = std::move(handler), bytes]() mutable { handler(error_code(), bytes); });
    return;
  }
  between_writes_ = false;
  deadlines_->Begin(Way::kWrite);
  Send(from,
       streams::BytesHandler(
           [this, bytes, handler = std::move(handler)](error_code error, std::size_t sent) mutable {
             deadlines_->End(Way::kWrite);
             between_writes_ = error || sent == bytes;
             write_ended_.Notify();
             handler(error, sent);
           },
           executor));
}

net::awaitable<bool> ClientStream::WriteLast(std::string bytes) {
  last_begun_ = true;
  co_await write_ended_.AwaitTrue(between_writes_);
  net::const_buffer rest = net::buffer(bytes);
  error_code error;
  deadlines_->Begin(Way::kWrite);
  while (!error && rest.size() > 0) {
    rest += co_await async_send_some(rest, net::redirect_error(net::use_awaitable, error));
  }
  deadlines_->End(Way::kWrite);
  co_return !error;
}

void beast_close_socket(ClientStream& stream) {
  error_code ignored;
  stream.socket().close(ignored);
}

void teardown(boost::beast::role_type role, ClientStream& stream, error_code& error) {
  using boost::beast::websocket::teardown;
  teardown(role, stream.socket(), error);
}

}  // namespace thunderhead::gateway
