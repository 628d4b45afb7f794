// The bytes of a connection to a server, plain or by TLS, to Asio and Beast a stream like any
// other. Used on one thread.
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

  // `tls` null: plain.
  ServerStream(boost::asio::io_context& io, std::shared_ptr<boost::asio::ssl::context> tls);

  void Connect(const boost::asio::ip::tcp::resolver::results_type& found, Then then);
  // The first after it has connected: `then` is called once the host of that name or address has
  // shown, where the stream is by TLS, that it is who it says.
  void Handshake(const std::string& host, Then then);
};

// Beast's hooks for the end of a WebSocket: that of its TCP connection.
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
