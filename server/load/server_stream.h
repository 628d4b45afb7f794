// An Asio stream over plain TCP or TLS for a connection to a server. Use it on one thread.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/beast/core/rate_policy.hpp>
#include <boost/beast/core/role.hpp>
#include <boost/system/error_code.hpp>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "streams/optional_tls.h"

namespace thunderhead::streams {
extern template class OptionalTls<boost::beast::unlimited_rate_policy>;
}

namespace thunderhead::load {

class ServerStream : public streams::OptionalTls<boost::beast::unlimited_rate_policy> {
 public:
  using Then = std::function<void(boost::system::error_code)>;

  // If `tls` is null, the stream uses plain TCP.
  ServerStream(boost::asio::io_context& io, std::shared_ptr<boost::asio::ssl::context> tls);

  void Connect(const boost::asio::ip::tcp::resolver::results_type& found, Then then);
  // Performs the TLS handshake, which must be the first operation after connecting. The server's
  // certificate is verified for `host`, a name or an address; then `then` gets the result. On a
  // plain stream, `then` is called at once.
  void Handshake(const std::string& host, Then then);
};

// Functions that Beast calls to close the TCP connection when a WebSocket ends.
void beast_close_socket(ServerStream& stream);
void teardown(boost::beast::role_type role, ServerStream& stream, boost::system::error_code& error);
template <typename Handler>
void async_teardown(boost::beast::role_type role, ServerStream& stream, Handler&& handler) {
  boost::system::error_code error;
  teardown(role, stream, error);
  boost::asio::post(stream.get_executor(), [handler = std::forward<Handler>(handler),
                                            error]() mutable { std::move(handler)(error); });
}

}  // namespace thunderhead::load
