#include "telemetry/operator_port.h"

#include <chrono>
#include <cstddef>
#include <deque>
#include <memory>
#include <thread>
#include <utility>

#include "absl/strings/str_cat.h"
#include "boost/asio/io_context.hpp"
#include "boost/asio/ip/tcp.hpp"
#include "boost/asio/steady_timer.hpp"
#include "boost/beast/core/flat_buffer.hpp"
#include "boost/beast/core/tcp_stream.hpp"
#include "boost/beast/http.hpp"

namespace thunderhead::telemetry {
namespace {

namespace asio = boost::asio;
namespace http = boost::beast::http;
using asio::ip::tcp;
using boost::system::error_code;
using Response = http::response<http::string_body>;

// The maximum number of connections. For another connection, the oldest is closed.
constexpr std::size_t kMaxConnections = 64;
constexpr std::size_t kMaxRequestBytes = 16 << 10;
constexpr std::chrono::milliseconds kAcceptPause{100};

Response Text(http::status status, const std::string& text) {
  Response response(status, 11);
  response.set(http::field::content_type, "text/plain; version=0.0.4; charset=utf-8");
  response.set(http::field::cache_control, "no-store");
  response.keep_alive(false);
  response.body() = text;
  response.prepare_payload();
  return response;
}

Response Answer(const http::request<http::empty_body>& request, const OperatorPages& pages) {
  const auto host = request[http::field::host];
  if (pages.allows_host && !pages.allows_host({host.data(), host.size()})) {
    return Text(
        http::status::forbidden,
        "this server does not answer to that name; start it with --allow-host and this name\n");
  }
  if (request.method() != http::verb::get) {
    return Text(http::status::method_not_allowed, "only GET is answered here\n");
  }
  const auto page = request.target();
  if (page == "/metrics") return Text(http::status::ok, pages.metrics());
  if (page != "/healthz" && page != "/readyz") {
    return Text(http::status::not_found, "the pages are /metrics, /healthz and /readyz\n");
  }
  const Health health = pages.health();
  const bool good = page == "/healthz" ? health.alive : health.ready;
  return Text(good ? http::status::ok : http::status::service_unavailable, health.state + "\n");
}

// One request and its response, within the timeout. The object keeps itself alive until the
// response is sent or the timeout has passed.
class Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(tcp::socket socket, const OperatorPages& pages)
      : stream_(std::move(socket)), pages_(pages) {}

  // `patience` is the timeout of the whole exchange.
  void Start(std::chrono::milliseconds patience) {
    stream_.expires_after(patience);
    http::async_read(stream_, buffer_, request_,
                     [self = shared_from_this()](const error_code& error, std::size_t) {
                       if (!error) self->Respond();
                     });
  }

  void Close() { stream_.close(); }

 private:
  void Respond() {
    response_ = Answer(request_, pages_);
    http::async_write(stream_, response_,
                      [self = shared_from_this()](const error_code&, std::size_t) {
                        error_code ignored;
                        self->stream_.socket().shutdown(tcp::socket::shutdown_both, ignored);
                      });
  }

  boost::beast::tcp_stream stream_;
  const OperatorPages& pages_;
  boost::beast::flat_buffer buffer_{kMaxRequestBytes};
  http::request<http::empty_body> request_;
  Response response_;
};

class RunningPort final : public OperatorPort {
 public:
  RunningPort(OperatorPages pages, std::chrono::milliseconds patience)
      : pages_(std::move(pages)), patience_(patience), acceptor_(io_), pause_(io_) {}

  ~RunningPort() override {
    // Stopping also ends open connections.
    io_.stop();
    if (thread_.joinable()) thread_.join();
  }

  absl::Status Listen(const std::string& host, std::uint16_t port) {
    error_code error;
    const tcp::endpoint endpoint(asio::ip::make_address(host, error), port);
    if (!error) acceptor_.open(endpoint.protocol(), error);
    if (!error) acceptor_.set_option(tcp::acceptor::reuse_address(true), error);
    if (!error) acceptor_.bind(endpoint, error);
    if (!error) acceptor_.listen(asio::socket_base::max_listen_connections, error);
    if (error) {
      return absl::UnavailableError(absl::StrCat("cannot listen for operators on ", host, ":", port,
                                                 " (", error.message(),
                                                 "); choose another address or port"));
    }
    port_ = acceptor_.local_endpoint().port();
    Accept();
    thread_ = std::thread([this] { io_.run(); });
    return absl::OkStatus();
  }

  std::uint16_t Port() const override { return port_; }

 private:
  void Accept() {
    acceptor_.async_accept([this](const error_code& error, tcp::socket socket) {
      if (!error) {
        Serve(std::move(socket));
        Accept();
        return;
      }
      // The process is probably out of file descriptors, so accepting pauses until some may be
      // free.
      pause_.expires_after(kAcceptPause);
      pause_.async_wait([this](const error_code& ended) {
        if (!ended) Accept();
      });
    });
  }

  void Serve(tcp::socket socket) {
    std::erase_if(connections_, [](const auto& connection) { return connection.expired(); });
    if (connections_.size() >= kMaxConnections) {
      if (const auto oldest = connections_.front().lock()) oldest->Close();
      connections_.pop_front();
    }
    const auto connection = std::make_shared<Connection>(std::move(socket), pages_);
    connections_.push_back(connection);
    connection->Start(patience_);
  }

  const OperatorPages pages_;
  const std::chrono::milliseconds patience_;
  asio::io_context io_{1};
  tcp::acceptor acceptor_;
  asio::steady_timer pause_;
  std::uint16_t port_ = 0;
  std::deque<std::weak_ptr<Connection>> connections_;  // oldest first; used only on the thread
  std::thread thread_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<OperatorPort>> OperatorPort::Open(
    const std::string& host, std::uint16_t port, OperatorPages pages,
    std::chrono::milliseconds patience) {
  auto opened = std::make_unique<RunningPort>(std::move(pages), patience);
  if (absl::Status status = opened->Listen(host, port); !status.ok()) return status;
  return opened;
}

}  // namespace thunderhead::telemetry
