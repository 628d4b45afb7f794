// The bytes of a connection to a server, plain or by TLS, to Asio and Beast a stream like any
// other. Used on one thread.
#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/async_result.hpp>
#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/asio/ssl/stream.hpp>
#include <boost/beast/core/basic_stream.hpp>
#include <boost/beast/core/flat_stream.hpp>
#include <boost/beast/core/role.hpp>
#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "streams/bytes_handler.h"

namespace thunderhead::load {

class ServerStream {
 public:
  // Asio's name for it.
  using executor_type = boost::asio::any_io_executor;
  using Then = std::function<void(boost::system::error_code)>;

  // `tls` null: plain.
  ServerStream(boost::asio::io_context& io, std::shared_ptr<boost::asio::ssl::context> tls);

  executor_type get_executor() { return plain_.get_executor(); }
  boost::asio::ip::tcp::socket& socket() { return plain_.socket(); }
  void expires_after(std::chrono::steady_clock::duration time) { plain_.expires_after(time); }
  void expires_never() { plain_.expires_never(); }
  void close() { plain_.close(); }

  void Connect(const boost::asio::ip::tcp::resolver::results_type& found, Then then);
  // The first after it has connected: `then` is called once the host of that name or address has
  // shown, where the stream is by TLS, that it is who it says.
  void Handshake(const std::string& host, Then then);

  template <typename Buffers, typename Token>
  auto async_read_some(const Buffers& buffers, Token&& token) {
    return boost::asio::async_initiate<Token, void(boost::system::error_code, std::size_t)>(
        [this](auto&& handler, const Buffers& into) {
          Read(into,
               streams::BytesHandler(std::forward<decltype(handler)>(handler), get_executor()));
        },
        token, buffers);
  }

  template <typename Buffers, typename Token>
  auto async_write_some(const Buffers& buffers, Token&& token) {
    return boost::asio::async_initiate<Token, void(boost::system::error_code, std::size_t)>(
        [this](auto&& handler, const Buffers& from) {
          Write(from,
                streams::BytesHandler(std::forward<decltype(handler)>(handler), get_executor()));
        },
        token, buffers);
  }

 private:
  using Plain = boost::beast::basic_stream<boost::asio::ip::tcp, executor_type>;
  // Makes one TLS record of several small buffers.
  using Tls = boost::beast::flat_stream<boost::asio::ssl::stream<Plain&>>;

  void Read(streams::FewBuffers<boost::asio::mutable_buffer> into, streams::BytesHandler handler);
  void Write(streams::FewBuffers<boost::asio::const_buffer> from, streams::BytesHandler handler);

  const std::shared_ptr<boost::asio::ssl::context> context_;  // outlives what is made of it
  Plain plain_;
  std::optional<Tls> tls_;
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
