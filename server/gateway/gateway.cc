#include "gateway/gateway.h"

#include <algorithm>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <utility>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "base/allowance.h"
#include "base/error_details.h"
#include "base/guarded.h"
#include "base/line_limit.h"
#include "base/status.h"
#include "gateway/awaitable.h"
#include "gateway/client_link.h"
#include "gateway/http_connection.h"
#include "gateway/open_links.h"
#include "gateway/refusals.h"
#include "gateway/site.h"
#include "gateway/tls_contexts.h"
#include "spdlog/spdlog.h"

namespace thunderhead::gateway {
namespace {

namespace net = boost::asio;
using boost::system::error_code;
using net::ip::tcp;

constexpr std::chrono::milliseconds kAcceptPause{100};

absl::StatusOr<net::ip::address> ParseAddress(const std::string& text) {
  error_code error;
  const net::ip::address address =
      net::ip::make_address(text == "localhost" ? "127.0.0.1" : text, error);
  if (error) {
    return absl::InvalidArgumentError(absl::StrCat(
        "'", text,
        "' is not an IP address to listen on; give one such as 127.0.0.1, ::1 or 0.0.0.0"));
  }
  return address;
}

std::string HostAndPort(const tcp::endpoint& endpoint) {
  const std::string host = endpoint.address().to_string();
  return endpoint.address().is_v6() ? absl::StrCat("[", host, "]:", endpoint.port())
                                    : absl::StrCat(host, ":", endpoint.port());
}

absl::Status CannotListen(const tcp::endpoint& endpoint, const error_code& error) {
  const std::string problem =
      absl::StrCat("cannot listen for browsers on ", HostAndPort(endpoint), ": ", error.message());
  if (error == net::error::address_in_use) {
    return absl::UnavailableError(
        absl::StrCat(problem, "; stop the program that uses this port or choose another one"));
  }
  if (error == net::error::access_denied) {
    return absl::PermissionDeniedError(absl::StrCat(problem, "; choose a port of 1024 or more"));
  }
  return absl::UnavailableError(absl::StrCat(problem, "; choose an address of this machine"));
}

}  // namespace

// The listener and its connections. Everything except construction, Listen() and destruction runs
// on `thread_`, so no lock is needed.
class Gateway::Listener {
 public:
  Listener(const GatewayOptions& options, StaticFiles files, HttpPolicy policy,
           std::shared_ptr<grpc::Channel> channel)
      : site_{options, std::make_shared<const StaticFiles>(std::move(files)), std::move(policy),
              grpc::GenericStub(std::move(channel))},
        acceptor_(io_),
        handshakes_(site_.options.max_handshakes_per_address),
        links_(site_.options.max_connections, site_.options.max_connections_per_address,
               site_.options.trusted_proxies, *site_.options.time) {}

  ~Listener() {
    if (!thread_.joinable()) return;
    net::post(io_, [this] { Stop(); });
    thread_.join();
  }

  absl::Status Listen(const tcp::endpoint& endpoint) {
    error_code error;
    acceptor_.open(endpoint.protocol(), error);
    if (!error) acceptor_.set_option(tcp::acceptor::reuse_address(true), error);
    if (!error) acceptor_.bind(endpoint, error);
    if (!error) acceptor_.listen(net::socket_base::max_listen_connections, error);
    if (!error) endpoint_ = acceptor_.local_endpoint(error);
    if (error) return CannotListen(endpoint, error);
    net::co_spawn(io_, Accept(), net::detached);
    thread_ = std::thread([this] { io_.run(); });
    return absl::OkStatus();
  }

  const tcp::endpoint& Endpoint() const { return endpoint_; }
  bool IsEncrypted() const { return site_.options.tls != nullptr; }

 private:
  net::awaitable<void> Accept() {
    while (!stopping_) {
      error_code error;
      tcp::socket socket =
          co_await acceptor_.async_accept(net::redirect_error(net::use_awaitable, error));
      if (stopping_) break;
      if (!error) {
        // If memory is missing for one connection, there may be enough memory for the next.
        const absl::Status admitted = base::Guarded([&] {
          Admit(std::move(socket));
          return absl::OkStatus();
        });
        if (!admitted.ok()) LogRefusal(std::string(admitted.message()));
        continue;
      }
      // Accepting has failed, probably because the process has run out of file descriptors.
      // Retrying at once would waste processor time.
      LogRefusal(error.message());
      net::steady_timer pause(io_, kAcceptPause);
      co_await pause.async_wait(net::redirect_error(net::use_awaitable, error));
    }
  }

  void LogRefusal(std::string_view why) {
    if (const auto left_out = accept_errors_.Take(std::chrono::system_clock::now()); left_out) {
      spdlog::warn("cannot accept a browser's connection: {} ({} more since the last line)", why,
                   *left_out);
    }
  }

  bool MayShakeHands(const ClientLink& link) {
    return !IsEncrypted() || site_.options.trusted_proxies.Holds(link.Peer()) ||
           !handshakes_.Take(link.Network(), site_.Now()).has_value();
  }

  void Admit(tcp::socket socket) {
    auto tls = IsEncrypted() ? site_.options.tls->Current() : nullptr;
    auto link = std::make_shared<ClientLink>(
        std::move(socket), std::move(tls), site_.options.write_stall_timeout, *site_.options.time);
    absl::Status refused;
    if (!MayShakeHands(*link)) {
      refused = base::TooManyHandshakes();
    } else if (!links_.MakeRoom(*link)) {
      refused = base::TooManyConnections();
    }
    if (!refused.ok()) return TellOfRefusal(site_.options, link->Peer(), "Connect", refused);
    links_.Add(link);
    net::co_spawn(io_, ServeConnection(link, site_),
                  [this, link](const std::exception_ptr&) { links_.Remove(link); });
  }

  void Stop() {
    stopping_ = true;
    error_code ignored;
    acceptor_.close(ignored);
    links_.StopAll();
    site_.page_threads.StopWaiting();
    site_.kept_threads.StopWaiting();
  }

  Site site_;
  net::io_context io_{1};
  tcp::acceptor acceptor_;
  tcp::endpoint endpoint_;
  base::Allowances handshakes_;  // per network
  OpenLinks links_;
  // Limits the log lines: without free file descriptors there are ten errors a second.
  base::LineLimit accept_errors_{1};
  bool stopping_ = false;
  std::thread thread_;
};

absl::StatusOr<std::unique_ptr<Gateway>> Gateway::Start(const GatewayOptions& options,
                                                        std::shared_ptr<grpc::Channel> channel) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const net::ip::address address, ParseAddress(options.address));
  THUNDERHEAD_ASSIGN_OR_RETURN(StaticFiles files, StaticFiles::Open(options.page_directory));
  auto listener = std::make_unique<Listener>(
      options, std::move(files),
      HttpPolicy(address.is_loopback(), options.allowed_hosts, options.allowed_origins),
      std::move(channel));
  THUNDERHEAD_RETURN_IF_ERROR(listener->Listen(tcp::endpoint(address, options.port)));
  return std::unique_ptr<Gateway>(new Gateway(std::move(listener)));
}

Gateway::Gateway(std::unique_ptr<Listener> listener) : listener_(std::move(listener)) {}
Gateway::~Gateway() = default;

uint16_t Gateway::Port() const { return listener_->Endpoint().port(); }

std::string Gateway::Url() const {
  const net::ip::address address = listener_->Endpoint().address();
  const char* const scheme = listener_->IsEncrypted() ? "https://" : "http://";
  // A browser cannot connect to a wildcard address such as 0.0.0.0, so the URL names localhost.
  if (address.is_unspecified() || address == net::ip::address_v4::loopback()) {
    return absl::StrCat(scheme, "localhost:", Port(), "/");
  }
  return absl::StrCat(scheme, HostAndPort(listener_->Endpoint()), "/");
}

}  // namespace thunderhead::gateway
