// Calls to a Thunderhead server by one protocol: gRPC, or WebSocket and gRPC-Web.
#pragma once

#include <cstddef>
#include <memory>
#include <stop_token>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "google/protobuf/io/zero_copy_stream.h"

namespace thunderhead::load {

// Hears what comes by one link; called by one thread at a time.
class Listener {
 public:
  virtual ~Listener() = default;
  virtual void OnMessage(google::protobuf::io::ZeroCopyInputStream& message, std::size_t bytes) = 0;
  // The call has ended, and not by Close(). OK: the server ended it as it should.
  virtual void OnEnd(const absl::Status& status) = 0;
};

struct LinkOptions {
  bool reads = true;        // false: never reads anything
  double kbit_per_s = 0.0;  // the rate at which it reads; 0: no limit
};

// A call of Interact on a connection of its own. Closed when it is destroyed.
class Link {
 public:
  virtual ~Link() = default;
  // Sends a serialized InteractRequest, after those sent before.
  virtual void Send(std::string message) = 0;
  // Sends nothing more, whatever Send() is given, so that the server ends the call.
  virtual void HalfClose() = 0;
  // Breaks off the call. Once it returns, the listener hears no more. Not from the listener.
  virtual void Close() = 0;
};

// How long a call may take.
struct CallPatience {
  double seconds = 0.0;
  std::stop_token stop = {};  // ends it at once
};

class Transport {
 public:
  virtual ~Transport() = default;
  virtual std::string Name() const = 0;
  // Begins to connect. The listener must outlive the link, and the transport both.
  virtual std::unique_ptr<Link> Interact(Listener& listener, const LinkOptions& options) = 0;
  // Calls a unary method of the service with a serialized request; returns the response, or
  // DEADLINE_EXCEEDED after the patience's seconds, CANCELLED when it is stopped. Safe from any
  // thread.
  virtual absl::StatusOr<std::string> Call(const std::string& method, const std::string& request,
                                           const CallPatience& patience) = 0;
};

// Credentials for a guarded server.
struct Access {
  std::string token;  // empty: none
  // CA certificates, as PEM, by which the server's certificate is verified. Empty: no TLS or, where
  // a transport always uses TLS, the machine's own CA certificates.
  std::string tls_roots;
};

// To HOST:PORT of a server's gRPC.
std::unique_ptr<Transport> MakeGrpcTransport(const std::string& address, const Access& access = {});
// To the HTTP port of a server or of a proxy before it.
std::unique_ptr<Transport> MakeWebSocketTransport(const std::string& host, int port,
                                                  const std::string& token = "");
// The same by TLS; the machine's certificates vouch where `access` has none. INVALID_ARGUMENT if
// its certificates cannot be read.
absl::StatusOr<std::unique_ptr<Transport>> MakeSecureWebSocketTransport(const std::string& host,
                                                                        int port,
                                                                        const Access& access);

}  // namespace thunderhead::load
