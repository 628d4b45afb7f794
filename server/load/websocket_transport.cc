#include <boost/asio/dispatch.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <deque>
#include <future>
#include <memory>
#include <string_view>
#include <utility>

#include "absl/strings/str_cat.h"
#include "google/protobuf/io/zero_copy_stream_impl_lite.h"
#include "load/io_thread.h"
#include "load/pace.h"
#include "load/server_stream.h"
#include "load/transport.h"
#include "load/web_wire.h"

namespace thunderhead::load {
namespace {

namespace net = boost::asio;
namespace http = boost::beast::http;
namespace ssl = boost::asio::ssl;
namespace websocket = boost::beast::websocket;
using boost::system::error_code;
using net::ip::tcp;

constexpr std::chrono::seconds kPatience{60};
constexpr char kBridgedService[] = "/thunderhead.v1.ThunderheadService/";
constexpr char kSubprotocol[] = "grpc-websocket.v1";
constexpr char kMessageKind = 0x00;
constexpr char kHalfCloseKind = 0x01;
constexpr char kTrailersKind = static_cast<char>(0x80);
// The size of the receive buffer of a viewer that reads at a limited rate or never. It is small, so
// that few messages wait in the kernel.
constexpr int kSlowReceiveBufferBytes = 64 << 10;

struct Host {
  std::string name;
  int port = 0;
  std::string token;                  // sent to the server; empty for none
  std::shared_ptr<ssl::context> tls;  // null for none

  std::string ToString() const {
    const bool is_ipv6 = name.find(':') != std::string::npos;
    return absl::StrCat(is_ipv6 ? "[" : "", name, is_ipv6 ? "]" : "", ":", port);
  }
  std::string Url() const {
    return absl::StrCat(tls == nullptr ? "http://" : "https://", ToString());
  }
};

absl::Status Unavailable(const Host& host, const char* doing, const error_code& error) {
  const bool is_http =
      error.category() == http::make_error_code(http::error::bad_version).category();
  return absl::UnavailableError(absl::StrCat("cannot ", doing, " ", host.Url(), ": ",
                                             error.message(),
                                             is_http ? "; is that the server's HTTP port?" : ""));
}

// One WebSocket call. Everything runs on the transport's thread, and handlers keep the call alive.
class WebSocketCall : public std::enable_shared_from_this<WebSocketCall> {
 public:
  WebSocketCall(net::io_context& io, Host host, Listener& listener, const LinkOptions& options)
      : host_(std::move(host)),
        listener_(&listener),
        options_(options),
        pace_(options.kbit_per_s),
        resolver_(io),
        socket_(io, host_.tls),
        delay_(io) {}

  void Start() {
    resolver_.async_resolve(host_.name, std::to_string(host_.port),
                            [self = shared_from_this()](error_code error, const auto& found) {
                              if (error) return self->Fail("find", error);
                              self->Connect(found);
                            });
  }

  void Send(std::string message) {
    // A message after a half-close is dropped, because the protocol allows none.
    if (half_closed_) return;
    half_closed_ = message.front() == kHalfCloseKind;
    unsent_.push_back(std::move(message));
    if (open_ && !writing_) WriteNext();
  }

  // Closes the connection without further calls of the listener.
  void Abandon() {
    listener_ = nullptr;
    resolver_.cancel();
    delay_.cancel();
    socket_.next_layer().close();
  }

 private:
  void Connect(const tcp::resolver::results_type& found) {
    if (listener_ == nullptr) return;
    socket_.next_layer().expires_after(kPatience);
    socket_.next_layer().Connect(found, [self = shared_from_this()](error_code error) {
      if (error) return self->Fail("connect to", error);
      self->socket_.next_layer().Handshake(self->host_.name, [self](error_code failed) {
        if (failed) return self->Fail("speak TLS with", failed);
        self->Upgrade();
      });
    });
  }

  void Upgrade() {
    tcp::socket& tcp_socket = socket_.next_layer().socket();
    error_code ignored;
    tcp_socket.set_option(tcp::no_delay(true), ignored);
    if (!options_.reads || pace_.IsLimited()) {
      tcp_socket.set_option(net::socket_base::receive_buffer_size(kSlowReceiveBufferBytes),
                            ignored);
    }
    socket_.set_option(websocket::stream_base::decorator([this](websocket::request_type& request) {
      if (!host_.token.empty()) request.set(http::field::authorization, "Bearer " + host_.token);
      request.set(http::field::sec_websocket_protocol, kSubprotocol);
    }));
    socket_.read_message_max(0);
    socket_.binary(true);
    socket_.async_handshake(host_.ToString(), absl::StrCat(kBridgedService, "Interact"),
                            [self = shared_from_this()](error_code error) {
                              if (error) return self->Fail("open a WebSocket to", error);
                              self->Opened();
                            });
  }

  void Opened() {
    socket_.next_layer().expires_never();
    open_ = true;
    WriteNext();
    if (options_.reads) Read();
  }

  void WriteNext() {
    writing_ = !unsent_.empty();
    if (!writing_) return;
    socket_.async_write(net::buffer(unsent_.front()),
                        [self = shared_from_this()](error_code error, std::size_t) {
                          // The error is not reported here, because the pending read reports it.
                          if (error) return;
                          self->unsent_.pop_front();
                          self->WriteNext();
                        });
  }

  void Read() {
    received_.clear();
    socket_.async_read(received_, [self = shared_from_this()](error_code error, std::size_t bytes) {
      if (error) return self->Fail("read from", error);
      if (!self->pace_.IsLimited()) return self->Take();
      self->delay_.expires_after(self->pace_.DelayOf(bytes, Pace::Clock::now()));
      self->delay_.async_wait([self](error_code) { self->Take(); });
    });
  }

  void Take() {
    if (listener_ == nullptr) return;
    const std::string_view message(static_cast<const char*>(received_.data().data()),
                                   received_.size());
    if (message.empty()) return End(absl::InternalError("the server sent an empty message"));
    const std::string_view payload = message.substr(1);
    if (message.front() == kTrailersKind) return End(StatusOfTrailers(payload));
    google::protobuf::io::ArrayInputStream stream(payload.data(), static_cast<int>(payload.size()));
    listener_->OnMessage(stream, payload.size());
    Read();
  }

  void Fail(const char* doing, const error_code& error) {
    if (error != websocket::error::closed) return End(Unavailable(host_, doing, error));
    const websocket::close_reason& why = socket_.reason();
    End(absl::UnavailableError(absl::StrCat("the server closed the WebSocket with ", why.code,
                                            why.reason.empty() ? "" : ": ", why.reason.c_str())));
  }

  void End(const absl::Status& status) {
    if (listener_ == nullptr) return;
    std::exchange(listener_, nullptr)->OnEnd(status);
    socket_.next_layer().close();
  }

  const Host host_;
  Listener* listener_;  // null after Abandon or End
  const LinkOptions options_;
  Pace pace_;
  tcp::resolver resolver_;
  websocket::stream<ServerStream, /*deflateSupported=*/false> socket_;
  net::steady_timer delay_;
  boost::beast::flat_buffer received_;
  std::deque<std::string> unsent_;
  bool open_ = false;
  bool writing_ = false;
  bool half_closed_ = false;
};

class WebSocketLink final : public Link {
 public:
  WebSocketLink(net::io_context& io, const Host& host, Listener& listener,
                const LinkOptions& options)
      : io_(io), call_(std::make_shared<WebSocketCall>(io, host, listener, options)) {
    net::post(io_, [call = call_] { call->Start(); });
  }

  ~WebSocketLink() override { WebSocketLink::Close(); }

  void Send(std::string message) override {
    message.insert(message.begin(), kMessageKind);
    Post(std::move(message));
  }
  void HalfClose() override { Post(std::string(1, kHalfCloseKind)); }
  void Close() override {
    std::promise<void> abandoned;
    net::post(io_, [&] {
      call_->Abandon();
      abandoned.set_value();
    });
    abandoned.get_future().wait();
  }

 private:
  void Post(std::string message) {
    // If the listener sends an answer, this code already runs on the transport's thread and the
    // message is sent at once.
    net::dispatch(io_, [call = call_, message = std::move(message)]() mutable {
      call->Send(std::move(message));
    });
  }

  net::io_context& io_;
  const std::shared_ptr<WebSocketCall> call_;
};

// A unary call by gRPC-Web, on a separate io_context.
class WebCall {
 public:
  WebCall(Host host, const std::string& method, const std::string& message)
      : host_(std::move(host)), stream_(io_, host_.tls) {
    const auto bytes = static_cast<std::uint32_t>(message.size());
    request_.method(http::verb::post);
    request_.target(absl::StrCat(kBridgedService, method));
    request_.version(11);
    request_.set(http::field::host, host_.ToString());
    request_.set(http::field::content_type, "application/grpc-web+proto");
    request_.set("X-Grpc-Web", "1");
    if (!host_.token.empty()) request_.set(http::field::authorization, "Bearer " + host_.token);
    request_.keep_alive(false);
    request_.body().assign(1, '\0');
    for (const int shift : {24, 16, 8, 0}) {
      request_.body().push_back(static_cast<char>(bytes >> shift & 0xFF));
    }
    request_.body() += message;
    request_.prepare_payload();
  }

  absl::StatusOr<std::string> Run(const CallPatience& patience) {
    tcp::resolver resolver(io_);
    error_code error;
    const auto found = resolver.resolve(host_.name, std::to_string(host_.port), error);
    if (error) return Unavailable(host_, "find", error);
    stream_.expires_after(std::chrono::milliseconds(std::llround(1e3 * patience.seconds)));
    stream_.Connect(found, [this](error_code failed) {
      if (failed) return Fail("connect to", failed);
      stream_.Handshake(host_.name, [this](error_code refused) {
        if (refused) return Fail("speak TLS with", refused);
        Write();
      });
    });
    const std::stop_callback stopping(patience.stop,
                                      [&] { net::post(io_, [this] { stream_.close(); }); });
    io_.run();
    if (!result_.ok() && patience.stop.stop_requested()) {
      return absl::CancelledError(absl::StrCat("the call of ", host_.Url(), " was stopped"));
    }
    return result_;
  }

 private:
  void Write() {
    http::async_write(stream_, request_, [this](error_code failed, std::size_t) {
      if (failed) return Fail("write to", failed);
      Read();
    });
  }

  void Read() {
    http::async_read(stream_, buffer_, response_, [this](error_code failed, std::size_t) {
      if (failed) return Fail("read from", failed);
      result_ = Result();
    });
  }

  absl::StatusOr<std::string> Result() const {
    if (response_.result() != http::status::ok) {
      return absl::UnavailableError(
          absl::StrCat(host_.Url(), " answered ", response_.result_int(), ": ", response_.body()));
    }
    return UnaryMessage(response_.body());
  }

  void Fail(const char* doing, const error_code& error) {
    result_ = Unavailable(host_, doing, error);
  }

  const Host host_;
  net::io_context io_;
  ServerStream stream_;
  boost::beast::flat_buffer buffer_;
  http::request<http::string_body> request_;
  http::response<http::string_body> response_;
  absl::StatusOr<std::string> result_ = absl::InternalError("the call did not end");
};

class WebSocketTransport final : public Transport {
 public:
  explicit WebSocketTransport(Host host) : host_(std::move(host)) {}

  std::string Name() const override { return "WebSocket"; }

  std::unique_ptr<Link> Interact(Listener& listener, const LinkOptions& options) override {
    return std::make_unique<WebSocketLink>(thread_.io(), host_, listener, options);
  }

  absl::StatusOr<std::string> Call(const std::string& method, const std::string& request,
                                   const CallPatience& patience) override {
    return WebCall(host_, method, request).Run(patience);
  }

 private:
  const Host host_;
  IoThread thread_;
};

}  // namespace

std::unique_ptr<Transport> MakeWebSocketTransport(const std::string& host, int port,
                                                  const std::string& token) {
  return std::make_unique<WebSocketTransport>(Host{host, port, token, nullptr});
}

absl::StatusOr<std::unique_ptr<Transport>> MakeSecureWebSocketTransport(const std::string& host,
                                                                        int port,
                                                                        const Access& access) {
  auto tls = std::make_shared<ssl::context>(ssl::context::tls_client);
  error_code error;
  if (access.tls_roots.empty()) {
    tls->set_default_verify_paths(error);
  } else {
    tls->add_certificate_authority(net::buffer(access.tls_roots), error);
  }
  if (error) {
    return absl::InvalidArgumentError(
        absl::StrCat("cannot use the certificates of authorities for TLS: ", error.message()));
  }
  tls->set_verify_mode(ssl::verify_peer);
  return std::make_unique<WebSocketTransport>(Host{host, port, access.token, std::move(tls)});
}

}  // namespace thunderhead::load
