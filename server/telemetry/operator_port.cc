#include "telemetry/operator_port.h"

#include <poll.h>
#include <sys/socket.h>

#include <array>
#include <atomic>
#include <chrono>
#include <sstream>
#include <thread>
#include <utility>

#include "absl/strings/str_cat.h"
#include "boost/asio/io_context.hpp"
#include "boost/asio/ip/tcp.hpp"
#include "boost/beast/http.hpp"

namespace thunderhead::telemetry {
namespace {

namespace asio = boost::asio;
namespace http = boost::beast::http;
using asio::ip::tcp;

using std::chrono::steady_clock;

// A client that takes longer to ask or to listen is cut off, so that the next can be answered.
constexpr std::chrono::seconds kPatience{2};

// False at the deadline.
bool AwaitReady(int socket, short events, steady_clock::time_point deadline) {
  const auto left =
      std::chrono::ceil<std::chrono::milliseconds>(deadline - steady_clock::now()).count();
  pollfd polled{socket, events, 0};
  return left > 0 && poll(&polled, 1, static_cast<int>(left)) > 0;
}

http::response<http::string_body> Text(http::status status, const std::string& text) {
  http::response<http::string_body> response(status, 11);
  response.set(http::field::content_type, "text/plain; version=0.0.4; charset=utf-8");
  response.set(http::field::cache_control, "no-store");
  response.keep_alive(false);
  response.body() = text;
  response.prepare_payload();
  return response;
}

http::response<http::string_body> Answer(const http::request<http::empty_body>& request,
                                         const OperatorPages& pages) {
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

class RunningPort final : public OperatorPort {
 public:
  explicit RunningPort(OperatorPages pages) : pages_(std::move(pages)), acceptor_(io_) {}

  ~RunningPort() override {
    stopping_ = true;
    // Wakes the thread from accept; closing would not.
    if (acceptor_.is_open()) shutdown(acceptor_.native_handle(), SHUT_RDWR);
    if (thread_.joinable()) thread_.join();
  }

  absl::Status Listen(const std::string& host, std::uint16_t port) {
    boost::system::error_code error;
    const tcp::endpoint endpoint(asio::ip::make_address(host, error), port);
    if (!error) acceptor_.open(endpoint.protocol(), error);
    if (!error) acceptor_.set_option(tcp::acceptor::reuse_address(true), error);
    if (!error) acceptor_.bind(endpoint, error);
    if (!error) acceptor_.listen(asio::socket_base::max_listen_connections, error);
    if (error) {
      return absl::UnavailableError(absl::StrCat("cannot listen for operators on ", host, ":", port,
                                                 " (", error.message(), "); choose another"));
    }
    port_ = acceptor_.local_endpoint().port();
    thread_ = std::thread([this] { Run(); });
    return absl::OkStatus();
  }

  std::uint16_t Port() const override { return port_; }

 private:
  void Run() {
    while (!stopping_) {
      tcp::socket socket(io_);
      boost::system::error_code error;
      acceptor_.accept(socket, error);
      if (stopping_) return;
      if (error) {
        std::this_thread::sleep_for(std::chrono::milliseconds(100));  // out of descriptors
        continue;
      }
      Serve(socket);
    }
  }

  void Serve(tcp::socket& socket) {
    const auto deadline = steady_clock::now() + kPatience;
    const int native = socket.native_handle();
    // By system calls, as Asio's have no deadline without a second thread.
    http::request_parser<http::empty_body> parser;
    std::string received;
    std::array<char, 4096> buffer{};
    boost::system::error_code error;
    while (!parser.is_done()) {
      if (!AwaitReady(native, POLLIN, deadline)) return;
      const ssize_t bytes = recv(native, buffer.data(), buffer.size(), MSG_DONTWAIT);
      if (bytes <= 0) return;
      received.append(buffer.data(), static_cast<std::size_t>(bytes));
      const std::size_t taken = parser.put(asio::buffer(received), error);
      if (error && error != http::error::need_more) return;
      received.erase(0, taken);
    }
    std::ostringstream answer;
    answer << Answer(parser.get(), pages_);
    const std::string text = answer.str();
    for (std::size_t sent = 0; sent < text.size();) {
      if (!AwaitReady(native, POLLOUT, deadline)) return;
      const ssize_t bytes =
          send(native, text.data() + sent, text.size() - sent, MSG_DONTWAIT | MSG_NOSIGNAL);
      if (bytes < 0) return;
      sent += static_cast<std::size_t>(bytes);
    }
    socket.shutdown(tcp::socket::shutdown_both, error);
  }

  const OperatorPages pages_;
  asio::io_context io_;
  tcp::acceptor acceptor_;
  std::uint16_t port_ = 0;
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<OperatorPort>> OperatorPort::Open(const std::string& host,
                                                                 std::uint16_t port,
                                                                 OperatorPages pages) {
  auto opened = std::make_unique<RunningPort>(std::move(pages));
  if (absl::Status status = opened->Listen(host, port); !status.ok()) return status;
  return opened;
}

}  // namespace thunderhead::telemetry
