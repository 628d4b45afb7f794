// An Asio stream over plain TCP or TLS. A timeout applies to the operations that begin after it was
// set. Use it on one thread.
#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/async_result.hpp>
#include <boost/asio/buffer.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/asio/ssl/stream.hpp>
#include <boost/beast/core/basic_stream.hpp>
#include <boost/beast/core/flat_stream.hpp>
#include <boost/system/error_code.hpp>
#include <chrono>
#include <cstddef>
#include <memory>
#include <optional>
#include <utility>

#include "streams/bytes_handler.h"

namespace thunderhead::streams {

// The class is compiled once for each RatePolicy, which is Beast's hook for rate limits. A header
// with a class that derives from it declares this template as extern, and one source file
// instantiates it.
template <typename RatePolicy>
class OptionalTls {
 public:
  // Asio requires this name.
  using executor_type = boost::asio::any_io_executor;

  // Wraps a socket, or creates a socket on an executor. A null `tls` means plain TCP.
  template <typename Source>
  OptionalTls(Source source, std::shared_ptr<boost::asio::ssl::context> tls)
      : context_(std::move(tls)), plain_(std::move(source)) {
    if (context_ != nullptr) tls_.emplace(plain_, *context_);
  }
  OptionalTls(const OptionalTls&) = delete;
  OptionalTls& operator=(const OptionalTls&) = delete;
  virtual ~OptionalTls() = default;

  executor_type get_executor() { return plain_.get_executor(); }
  boost::asio::ip::tcp::socket& socket() { return plain_.socket(); }
  void expires_after(std::chrono::steady_clock::duration time) { plain_.expires_after(time); }
  void expires_at(std::chrono::steady_clock::time_point time) { plain_.expires_at(time); }
  void expires_never() { plain_.expires_never(); }
  void cancel() { plain_.cancel(); }
  void close() { plain_.close(); }

  template <typename Buffers, typename Token>
  auto async_read_some(const Buffers& buffers, Token&& token) {
    return Begin<&OptionalTls::Read>(buffers, std::forward<Token>(token));
  }
  template <typename Buffers, typename Token>
  auto async_write_some(const Buffers& buffers, Token&& token) {
    return Begin<&OptionalTls::Write>(buffers, std::forward<Token>(token));
  }

 protected:
  using Plain = boost::beast::basic_stream<boost::asio::ip::tcp, executor_type, RatePolicy>;

  Plain& PlainStream() { return plain_; }
  // Returns the TLS layer, or null on a plain stream.
  boost::asio::ssl::stream<Plain&>* TlsStream() {
    return tls_.has_value() ? &tls_->next_layer() : nullptr;
  }

  // Works like async_write_some, but calls Send instead of Write, which a derived class may
  // override.
  template <typename Buffers, typename Token>
  auto async_send_some(const Buffers& buffers, Token&& token) {
    return Begin<&OptionalTls::Send>(buffers, std::forward<Token>(token));
  }

  // Called by async_read_some. A derived class that limits the time of reads overrides it.
  virtual void Read(FewBuffers<boost::asio::mutable_buffer> into, BytesHandler handler);
  void Send(FewBuffers<boost::asio::const_buffer> from, BytesHandler handler);
  // Called by async_write_some; sends the bytes. A derived class that counts its writes overrides
  // it.
  virtual void Write(FewBuffers<boost::asio::const_buffer> from, BytesHandler handler);

 private:
  // A flat_stream makes one TLS record of several small buffers.
  using Tls = boost::beast::flat_stream<boost::asio::ssl::stream<Plain&>>;

  // Calls `kOperation` with the handler that Asio makes from the completion token.
  template <auto kOperation, typename Buffers, typename Token>
  auto Begin(const Buffers& buffers, Token&& token) {
    return boost::asio::async_initiate<Token, void(boost::system::error_code, std::size_t)>(
        [this](auto&& handler, const Buffers& bytes) {
          (this->*kOperation)(
              bytes, BytesHandler(std::forward<decltype(handler)>(handler), get_executor()));
        },
        token, buffers);
  }

  const std::shared_ptr<boost::asio::ssl::context> context_;  // outlives tls_
  Plain plain_;
  std::optional<Tls> tls_;
};

template <typename RatePolicy>
void OptionalTls<RatePolicy>::Read(FewBuffers<boost::asio::mutable_buffer> into,
                                   BytesHandler handler) {
  if (tls_.has_value()) {
    tls_->async_read_some(into, std::move(handler));
  } else {
    plain_.async_read_some(into, std::move(handler));
  }
}

template <typename RatePolicy>
void OptionalTls<RatePolicy>::Send(FewBuffers<boost::asio::const_buffer> from,
                                   BytesHandler handler) {
  if (tls_.has_value()) {
    tls_->async_write_some(from, std::move(handler));
  } else {
    plain_.async_write_some(from, std::move(handler));
  }
}

template <typename RatePolicy>
void OptionalTls<RatePolicy>::Write(FewBuffers<boost::asio::const_buffer> from,
                                    BytesHandler handler) {
  Send(from, std::move(handler));
}

}  // namespace thunderhead::streams
