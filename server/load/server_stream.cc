#include "load/server_stream.h"

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/ip/address.hpp>
#include <boost/asio/ssl/host_name_verification.hpp>
#include <utility>

namespace thunderhead::streams {
template class OptionalTls<boost::beast::unlimited_rate_policy>;
}

namespace thunderhead::load {

namespace net = boost::asio;
using boost::system::error_code;

ServerStream::ServerStream(net::io_context& io, std::shared_ptr<net::ssl::context> tls)
    : OptionalTls(net::any_io_executor(io.get_executor()), std::move(tls)) {}

void ServerStream::Connect(const net::ip::tcp::resolver::results_type& found, Then then) {
  PlainStream().async_connect(
      found,
      [then = std::move(then)](error_code error, const net::ip::tcp::endpoint&) { then(error); });
}

void ServerStream::Handshake(const std::string& host, Then then) {
  auto* tls = TlsStream();
  if (tls == nullptr) return then(error_code());
  error_code is_no_address;
  net::ip::make_address(host, is_no_address);
  // The name is sent, so that a server with certificates for several names chooses the right one.
  if (is_no_address) SSL_set_tlsext_host_name(tls->native_handle(), host.c_str());
  tls->set_verify_callback(net::ssl::host_name_verification(host));
  tls->async_handshake(net::ssl::stream_base::client, std::move(then));
}

void beast_close_socket(ServerStream& stream) {
  error_code ignored;
  stream.socket().close(ignored);
}

void teardown(boost::beast::role_type /*client*/, ServerStream& stream, error_code& error) {
  stream.socket().shutdown(net::ip::tcp::socket::shutdown_both, error);
  beast_close_socket(stream);
}

}  // namespace thunderhead::load
