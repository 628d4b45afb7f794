// The bridge from browsers to Thunderhead. One HTTP/1.1 port serves the built page, /healthz, and
// calls to a gRPC channel. Unary and server-streaming calls use gRPC-Web (binary). Calls of any
// kind, including bidirectional ones, use a WebSocket (websocket_protocol.h has its wire format).
// The gateway is independent of message types and storms. It needs no proxy in front;
// deploy/haproxy/ shows how to add one.
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
#include "base/file_descriptor.h"
#include "base/own_file.h"
#include "base/time_source.h"
#include "base/trusted_proxies.h"
#include "grpcpp/channel.h"

namespace thunderhead::gateway {

class TlsContexts;

// The contents that a file must have.
struct FileContents {
  std::uint64_t bytes = 0;
  std::string sha256;  // in lower-case hexadecimal
};

// A file that the service provides at a path that cannot be guessed, such as a render job's result.
struct KeptFile {
  std::string path;
  std::string entity_tag;  // without quotes; differs for different contents
  // Called on the gateway's thread when the client has been sent the complete file. It may be
  // empty, and must not block.
  std::function<void()> on_sent = nullptr;
  // The size and digest that the file had when it was written. If the file differs now, the
  // response is 500. The digest of a file larger than kCheckedFirst_bytes is computed while it is
  // sent: if it differs, the connection breaks before the last bytes. Requests for parts of such a
  // file are checked by size only. If absent, the file is sent unchecked.
  std::optional<FileContents> contents = std::nullopt;

  static constexpr std::uint64_t kCheckedFirst_bytes = std::uint64_t{64} << 20;
};

// A connection or request that was refused because it violated a rule or limit of the gateway.
struct GatewayRefusal {
  std::string peer;  // the client's address; for trusted proxies, the address in X-Forwarded-For
  // What was refused: "Connect", "Request", "Preflight", "WebSocket", "Message" or "Answer".
  std::string act;
  absl::Status why;  // the reason, also machine-readable; contains nothing that the client sent
};

struct GatewayOptions {
  // An IP address or "localhost".
  std::string address = "127.0.0.1";
  // The port; 0 chooses a free one, see Gateway::Port().
  uint16_t port = 0;
  // The certificate of the port. If null, TLS is off.
  std::shared_ptr<TlsContexts> tls;
  // Names of this server in addition to its addresses. Requests for other hosts are refused.
  // Otherwise, a foreign web site could reach the server by letting its own name resolve to the
  // server's address. HttpPolicy has the rules.
  std::vector<std::string> allowed_hosts;
  // The folder of the built page; empty for none.
  std::string page_directory;
  // Finds files that are not in the page's folder; may be empty. It must not block.
  std::function<std::optional<KeptFile>(std::string_view path)> find_kept_file;
  // Opens a regular file. It may block as long as the storage does. Tests replace it.
  std::function<absl::StatusOr<base::FileDescriptor>(const std::string& path)> open_file =
      &base::OpenOwnFile;
  // Called on the gateway's thread for each refusal; may be empty. It must not block. It is not
  // called for mistakes: a nonexistent path, a wrong method or a malformed request.
  std::function<void(const GatewayRefusal&)> on_refusal;
  // Origins of other pages whose scripts may make calls, for example "http://localhost:5173". The
  // page served here needs no entry.
  std::vector<std::string> allowed_origins;
  // Proxies whose X-Forwarded-For gives the address of their client. Only max_connections limits
  // the connections from these proxies.
  base::TrustedProxies trusted_proxies;
  // Maximum size of a request message. A larger message gets RESOURCE_EXHAUSTED, or closes its
  // WebSocket with 1009. Responses are limited only by the gRPC channel and by max_unsent_bytes.
  size_t max_message_bytes = 4u << 20;
  // Maximum total size of the response messages that wait for their clients to receive them. Above
  // it, the clients with the lowest rates are disconnected, if they have had five seconds. If that
  // does not free enough memory, the call whose message was to be added ends with
  // RESOURCE_EXHAUSTED.
  size_t max_unsent_bytes = size_t{512} << 20;
  // Maximum numbers of connections, in total and from one address. At a maximum, a new connection
  // replaces an existing one. The first choice is the connection that has gone longest without a
  // complete request, or a WebSocket that the service has not answered. The second choice is a
  // connection that takes long to receive a file. If all connections have calls, the new connection
  // is refused.
  size_t max_connections = 768;
  size_t max_connections_per_address = 512;
  // Maximum number of TLS connections per second that one address may open, with bursts of twice as
  // many. Further ones are refused, because each TLS handshake costs a signature. 0 means no limit.
  // Trusted proxies have no limit.
  double max_handshakes_per_address = 256.0;
  // Timeout of a connection without a call, while it waits for the next request.
  std::chrono::milliseconds idle_timeout = std::chrono::seconds(60);
  // Timeout of a request's header, of a TLS handshake, and of the start of the first message on a
  // WebSocket. A request's body has three times as long.
  std::chrono::milliseconds header_timeout = std::chrono::seconds(10);
  // Timeout for finding and opening a file, after which the response is 503. It is also the timeout
  // for reading each part of the file from storage, after which the connection is closed.
  std::chrono::milliseconds file_timeout = std::chrono::seconds(10);
  // Minimum rate at which a client must receive a file, a text, or a message of a call's response.
  // The client has three header timeouts plus the time that the bytes take at this rate.
  double min_bytes_per_second = 8192.0;
  // Timeout of a connection whose client accepts no bytes. It also cancels the connection's call.
  // For small responses (by default below 720 KiB), the limit of min_bytes_per_second is reached
  // earlier.
  std::chrono::milliseconds write_stall_timeout = std::chrono::seconds(120);
  // A WebSocket on which nothing arrives for this interval is pinged. If nothing arrives during
  // another interval, the client is disconnected and its call is cancelled. While the gateway reads
  // nothing from the client, it is enough that the client's machine acknowledges the ping, up to
  // 200 ms later.
  std::chrono::milliseconds websocket_ping_interval = std::chrono::seconds(15);

  // The time source of all timeouts above. It must outlive the gateway.
  const base::TimeSource* time = &base::SteadyTime();

  // The timeout of a request's body, and the fixed part of DeliveryTime(), as a multiple of
  // header_timeout.
  static constexpr int kHeaderTimeouts = 3;
  // Returns the time that a client has to receive `bytes` bytes.
  std::chrono::milliseconds DeliveryTime(uint64_t bytes) const {
    return kHeaderTimeouts * header_timeout +
           std::chrono::ceil<std::chrono::milliseconds>(
               std::chrono::duration<double>(static_cast<double>(bytes) / min_bytes_per_second));
  }
};

class Gateway {
 public:
  // Starts a gateway that serves on a separate thread until it is destroyed. `channel` may connect
  // to any gRPC server. It needs SetMaxReceiveMessageSize(-1) if responses may exceed gRPC's 4 MiB.
  // For a server in the same process, use a Unix socket rather than Server::InProcessChannel(). In
  // gRPC 1.51, an in-process channel crashes on calls made after Server::Shutdown(), and never ends
  // a call whose handler finishes before its last message was read.
  static absl::StatusOr<std::unique_ptr<Gateway>> Start(const GatewayOptions& options,
                                                        std::shared_ptr<grpc::Channel> channel);

  // Stops listening and closes every connection. WebSockets are closed with 1001, and their clients
  // have a second to answer. Cancels the calls of the connections and waits until these calls have
  // ended.
  ~Gateway();
  Gateway(const Gateway&) = delete;
  Gateway& operator=(const Gateway&) = delete;

  uint16_t Port() const;
  // Returns the page's address, for example "http://localhost:8080/".
  std::string Url() const;

 private:
  class Listener;
  explicit Gateway(std::unique_ptr<Listener> listener);

  std::unique_ptr<Listener> listener_;
};

}  // namespace thunderhead::gateway
