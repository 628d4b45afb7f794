// Thunderhead for browsers: one HTTP/1.1 port with the built page, /healthz, and a bridge to a gRPC
// channel: gRPC-Web (binary) for unary and server-streaming calls, a WebSocket for calls of any
// kind, bidirectional ones too (websocket_protocol.h has its wire format). Knows no message type
// and nothing of storms. Needs no proxy in front of it; deploy/haproxy/ shows how to add one.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "base/time_source.h"
#include "base/trusted_proxies.h"
#include "grpcpp/channel.h"

namespace thunderhead::gateway {

// A file that the service keeps under a path which nobody can guess.
struct KeptFile {
  std::string path;
  std::string entity_tag;  // another one for other contents; without quotes
  // Called on the gateway's thread when the client has been sent the file to its end; empty: nobody
  // is told. Must not block.
  std::function<void()> on_sent = nullptr;
};

// A connection or request that broke a rule or a limit of the gateway, and so became no call.
struct GatewayRefusal {
  std::string peer;  // for whom it was, with X-Forwarded-For of trusted proxies
  std::string act;   // "Connect", "Request", "Preflight", "WebSocket", "Message" or "Answer"
  absl::Status why;  // with a reason for programs; repeats nothing that the client sent
};

struct GatewayOptions {
  // An IP address or "localhost".
  std::string address = "127.0.0.1";
  // 0 chooses a free one; see Gateway::Port().
  uint16_t port = 0;
  // PEM files, loaded again when they change; both empty: no TLS.
  std::string tls_certificate;
  std::string tls_key;
  // Names of this server besides its addresses. Requests for others are refused, so that a foreign
  // web site cannot reach the server by resolving its own name to it (HttpPolicy has the rules).
  std::vector<std::string> allowed_hosts;
  // The built page; empty: none.
  std::string page_directory;
  // Finds what the page's folder does not have; empty: nothing more. Must not block.
  std::function<std::optional<KeptFile>(std::string_view path)> find_kept_file;
  // Told of each refusal, on the gateway's thread; empty: nobody is. Must not block. A path where
  // there is nothing, a wrong method and a malformed request are mistakes, not refusals.
  std::function<void(const GatewayRefusal&)> on_refusal;
  // Origins of other pages that may call, for example "http://localhost:5173". The page served here
  // needs none.
  std::vector<std::string> allowed_origins;
  // Proxies that say by X-Forwarded-For for whom they ask; they may have as many connections as
  // there are in all.
  base::TrustedProxies trusted_proxies;
  // Largest request message; larger ones get RESOURCE_EXHAUSTED, or close a WebSocket with 1009.
  // Responses are limited only by the channel, and by max_unsent_bytes.
  size_t max_message_bytes = 4u << 20;
  // Messages of calls' answers that wait for their clients to take them, all together. Beyond it,
  // the clients that take theirs at the lowest rate, and have had five seconds, are cut off; where
  // that makes no room, the call ends with RESOURCE_EXHAUSTED.
  size_t max_unsent_bytes = size_t{512} << 20;
  // Maximum numbers of connections, in all and from one address. At a maximum, a new connection
  // takes the place of the most expendable one: the longest that has sent no whole request, or a
  // WebSocket that the service has not answered, else one that takes long to read a file. Where all
  // are calls, the new connection is refused.
  size_t max_connections = 768;
  size_t max_connections_per_address = 512;
  // By TLS a new connection costs the processor a signature. One address may open so many a second,
  // twice as many at once; further ones are refused. 0: no limit. Trusted proxies have none.
  double max_handshakes_per_address = 256.0;
  // Closes a connection without a call on which no request begins within this time.
  std::chrono::milliseconds idle_timeout = std::chrono::seconds(60);
  // A request's header, and a TLS handshake, must be complete within this time, a WebSocket's first
  // message must begin within it, and the body after a header within three times as long.
  std::chrono::milliseconds header_timeout = std::chrono::seconds(10);
  // A file must be found and opened within this time, else the answer is 503; each part of it must
  // be read from its storage within it, else the connection is closed.
  std::chrono::milliseconds file_timeout = std::chrono::seconds(10);
  // A file, a text and each message of a call's answer must be taken by the client within three
  // header timeouts and the time that it takes at this rate.
  double min_bytes_per_second = 8192.0;
  // Closes a connection whose client accepts no bytes for this time, too, and cancels its call.
  // Small answers reach the limit of min_bytes_per_second before: by default, those below 720 KiB.
  std::chrono::milliseconds write_stall_timeout = std::chrono::seconds(120);
  // Pings the client of a WebSocket that sent nothing for this time, and drops it, cancelling its
  // call, if nothing comes for this time again. While it is held back, its machine need only
  // acknowledge the ping, which it may do 200 ms later.
  std::chrono::milliseconds websocket_ping_interval = std::chrono::seconds(15);

  // Every time above is by this source, which must outlive the gateway.
  const base::TimeSource* time = &base::SteadyTime();

  // Timeout of a body, of a text and of the first bytes of a file, in timeouts of a header.
  static constexpr int kHeaderTimeouts = 3;
  // How long a client may take for so many bytes.
  std::chrono::milliseconds DeliveryTime(uint64_t bytes) const {
    return kHeaderTimeouts * header_timeout +
           std::chrono::ceil<std::chrono::milliseconds>(
               std::chrono::duration<double>(static_cast<double>(bytes) / min_bytes_per_second));
  }
};

class Gateway {
 public:
  // Listens and serves on a thread of its own until destroyed. `channel` may be that of any gRPC
  // server; it needs SetMaxReceiveMessageSize(-1) if responses may exceed gRPC's 4 MiB. For a
  // server in the same process use a Unix socket rather than Server::InProcessChannel(): in
  // gRPC 1.51 the latter crashes on calls made after Server::Shutdown(), and never ends a call
  // whose handler finishes before its last message was read.
  static absl::StatusOr<std::unique_ptr<Gateway>> Start(const GatewayOptions& options,
                                                        std::shared_ptr<grpc::Channel> channel);

  // Stops listening, closes every connection (WebSockets with 1001, which a client has a second to
  // answer), cancels the calls on them and waits for their end.
  ~Gateway();
  Gateway(const Gateway&) = delete;
  Gateway& operator=(const Gateway&) = delete;

  uint16_t Port() const;
  // The page's address, for example "http://localhost:8080/".
  std::string Url() const;

 private:
  class Listener;
  explicit Gateway(std::unique_ptr<Listener> listener);

  std::unique_ptr<Listener> listener_;
};

}  // namespace thunderhead::gateway
