#include "gateway/client_stream.h"

#include <utility>

namespace thunderhead::gateway {

namespace net = boost::asio;
using boost::system::error_code;

ClientStream::ClientStream(net::ip::tcp::socket socket, std::shared_ptr<net::ssl::context> tls)
    : context_(std::move(tls)), plain_(std::move(socket)) {
  if (context_ != nullptr) tls_.emplace(plain_, *context_);
}

net::awaitable<bool> ClientStream::Handshake() {
  error_code error;
  if (tls_.has_value()) {
    co_await tls_->next_layer().async_handshake(net::ssl::stream_base::server,
                                                net::redirect_error(net::use_awaitable, error));
  }
  co_return !error;
}

void ClientStream::Read(FewBuffers<net::mutable_buffer> into, BytesHandler handler) {
  if (tls_.has_value()) {
    tls_->async_read_some(into, std::move(handler));
  } else {
    plain_.async_read_some(into, std::move(handler));
  }
}

void ClientStream::Write(FewBuffers<net::const_buffer> from, BytesHandler handler) {
  if (tls_.has_value()) {
    tls_->async_write_some(from, std::move(handler));
  } else {
    plain_.async_write_some(from, std::move(handler));
  }
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
