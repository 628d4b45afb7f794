// Calls to a Thunderhead server over one of two transports: gRPC, or WebSocket and gRPC-Web.
#pragma once

#include <cstddef>
#include <memory>
#include <stop_token>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "google/protobuf/io/zero_copy_stream.h"

namespace thunderhead::load {

// Receives the messages of one link. It is called by one thread at a time.
class Listener {
 public:
  virtual ~Listener() = default;
  virtual void OnMessage(google::protobuf::io::ZeroCopyInputStream& message, std::size_t bytes) = 0;
  // Reports that the call has ended other than by Close(). OK means that the server ended the call
  // normally.
  virtual void OnEnd(const absl::Status& status) = 0;
};

struct LinkOptions {
  bool reads = true;        // false for a link that never reads
  double kbit_per_s = 0.0;  // the rate at which the link reads; 0 means no limit
};

// A call of Interact on a separate connection. Destroying the object closes the call.
class Link {
 public:
  virtual ~Link() = default;
  // Sends a serialized InteractRequest, after all earlier ones.
  virtual void Send(std::string message) = 0;
  // Ends sending, upon which the server ends the call. Later calls of Send() are ignored.
  virtual void HalfClose() = 0;
  // Aborts the call. After it returns, the listener is not called again. The listener itself must
  // not call it.
  virtual void Close() = 0;
};

// How long a call may take.
struct CallPatience {
  double seconds = 0.0;
  std::stop_token stop = {};  // ends the call at once
};

class Transport {
 public:
  virtual ~Transport() = default;
  virtual std::string Name() const = 0;
  // Starts to connect. The listener must outlive the link, and the transport must outlive both.
  virtual std::unique_ptr<Link> Interact(Listener& listener, const LinkOptions& options) = 0;
  // Calls a unary method of the service with a serialized request and returns the serialized
  // response. After the timeout, returns DEADLINE_EXCEEDED (gRPC) or UNAVAILABLE (gRPC-Web).
  // Returns CANCELLED if `patience.stop` is requested. Safe to call from any thread.
  virtual absl::StatusOr<std::string> Call(const std::string& method, const std::string& request,
                                           const CallPatience& patience) = 0;
};

// Credentials for a server with access control.
struct Access {
  std::string token;  // bearer token; empty for none
  // CA certificates as PEM, by which the server's certificate is verified. If empty, gRPC uses no
  // TLS, and a transport that always uses TLS uses the machine's CA certificates.
  std::string tls_roots;
};

// Returns a transport to HOST:PORT of a server's gRPC service.
std::unique_ptr<Transport> MakeGrpcTransport(const std::string& address, const Access& access = {});
// Returns a transport to the HTTP port of a server, or of a proxy in front of it.
std::unique_ptr<Transport> MakeWebSocketTransport(const std::string& host, int port,
                                                  const std::string& token = "");
// Returns a transport to the HTTP port with TLS. If `access` has no CA certificates, the machine's
// CA certificates are used. Returns INVALID_ARGUMENT if the certificates in `access` cannot be
// read.
absl::StatusOr<std::unique_ptr<Transport>> MakeSecureWebSocketTransport(const std::string& host,
                                                                        int port,
                                                                        const Access& access);

}  // namespace thunderhead::load
