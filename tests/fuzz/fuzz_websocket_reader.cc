// Fuzzes the gateway's message reader with the same bytes as fuzz_gateway_websocket. It uses no
// socket, no call and no thread, so it is some hundred times as fast.
#include "gateway/websocket_reader.h"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/beast/_experimental/test/stream.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <cstdint>
#include <cstdlib>
#include <exception>
#include <string>

#include "tests/fuzz/must.h"
#include "tests/fuzz/websocket_bytes.h"

namespace thunderhead::gateway {
namespace {

namespace net = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using boost::system::error_code;
using Socket = beast::websocket::stream<beast::test::stream, /*deflateSupported=*/false>;

constexpr std::size_t kMaxMessageBytes = 1U << 12;

using fuzz::Must;

http::request<http::string_body> Upgrade() {
  http::request<http::string_body> request(http::verb::get, "/a.B/C", 11);
  request.set(http::field::host, "localhost");
  request.set(http::field::upgrade, "websocket");
  request.set(http::field::connection, "Upgrade");
  request.set(http::field::sec_websocket_key, "AQIDBAUGBwgJCgsMDQ4PEA==");
  request.set(http::field::sec_websocket_version, "13");
  return request;
}

// Reads messages as WebSocketExchange does, and checks that what a call would receive keeps the
// protocol's rules.
net::awaitable<void> Take(Socket& socket) {
  static const http::request<http::string_body> upgrade = Upgrade();
  error_code error;
  co_await socket.async_accept(upgrade, net::redirect_error(net::use_awaitable, error));
  Must(!error);
  WebSocketReader<Socket> reader(socket);
  reader.Limit(kMaxMessageBytes);
  bool ended = false;
  error = co_await reader.ReadStart();
  while (!error) {
    if (const auto violation = FindViolation(reader.Start()); violation.has_value()) {
      co_await socket.async_close(*violation, net::redirect_error(net::use_awaitable, error));
      co_return;
    }
    Must(!ended && socket.got_binary());
    ended = reader.IsHalfClose();
    beast::flat_buffer payload;
    error = co_await reader.ReadPayload(payload);
    Must(payload.size() <= kMaxMessageBytes && (!ended || payload.size() == 0));
    if (!error) error = co_await reader.ReadStart();
  }
}

}  // namespace
}  // namespace thunderhead::gateway

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  namespace gateway = thunderhead::gateway;
  namespace net = boost::asio;
  if (size == 0) return 0;
  // All inputs share one context, because its kernel objects cost more than everything else.
  static net::io_context context(1);
  context.restart();
  boost::beast::test::stream client(context);
  gateway::Socket socket{boost::beast::test::stream(context)};
  socket.next_layer().connect(client);
  socket.next_layer().append(thunderhead::fuzz::WebSocketBytes(data, size));
  // Bytes arrive one at a time, or in parts of any size.
  if (const std::size_t part = data[0] / 2; part > 0) socket.next_layer().read_size(part);
  socket.next_layer().close_remote();
  bool ended = false;
  net::co_spawn(context, gateway::Take(socket), [&ended](const std::exception_ptr& error) {
    if (error) std::abort();
    ended = true;
  });
  context.run();
  if (!ended) std::abort();
  return 0;
}
