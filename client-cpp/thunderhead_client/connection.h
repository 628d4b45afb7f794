// A connection to one server: its address, encryption and token. It holds everything that a call
// needs in addition to its messages.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <set>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "grpcpp/grpcpp.h"
#include "thunderhead/v1/thunderhead.grpc.pb.h"

namespace thunderhead::client {

struct ServerAccess {
  std::string address;  // HOST:PORT of the server's gRPC port
  // PEM file of the authority that signed the server's certificate; empty: no encryption.
  std::string tls_ca_file;
  // File with a bearer token, read again for each call; empty: sends no token.
  std::string token_file;
  // If true, the token is also sent to other machines without encryption. Anyone on the network
  // path can then read it.
  bool allow_plaintext_token = false;
};

// Cancels unary calls from another thread. The owner of the calls can then be destroyed without
// waiting for a server that does not answer.
class Canceller {
 public:
  // Cancels the running calls. Every later call ends at once.
  void Cancel();

 private:
  friend class Connection;
  class Running;

  std::mutex mutex_;
  bool cancelled_ = false;
  std::set<grpc::ClientContext*> running_;
};

// Registers one call with its canceller while the call runs.
class Canceller::Running {
 public:
  Running(Canceller& canceller, grpc::ClientContext& context);
  ~Running();
  Running(const Running&) = delete;
  Running& operator=(const Running&) = delete;

 private:
  Canceller& canceller_;
  grpc::ClientContext& context_;
};

class Connection {
 public:
  // Makes a connection object, which connects to the server at its first call. Returns an error if
  // the address is invalid, if the certificate file is unreadable or not PEM, or if the token file
  // is unreadable or empty. Also returns an error if a token would be sent unencrypted to another
  // machine without allow_plaintext_token.
  static absl::StatusOr<std::shared_ptr<Connection>> Open(ServerAccess access);

  v1::ThunderheadService::Stub& stub() const { return *stub_; }
  const std::string& address() const { return access_.address; }

  // Waits until the server is connected, for at most a few seconds or until `gives_up` returns
  // true. `gives_up` is called ten times a second. A retry needs this wait, because an immediate
  // call would fail with the channel's last error. Without a caller that waits, gRPC would try to
  // reconnect the channel only every five seconds.
  void AwaitReconnection(const std::function<bool()>& gives_up) const;

  // Returns the reason why a call failed, as text for people. If the server answered, the text is
  // its own message. If no server answered, the text names a likely cause and suggests what to do.
  std::string Explain(const grpc::Status& status) const;

  // Adds the token to the call's metadata. Returns an error if the token file is unreadable or
  // empty.
  absl::Status Authorize(grpc::ClientContext& context) const;

  // Makes one unary call with the timeout `patience`, such as Call(&Stub::ListStorms, request,
  // &response, patience, canceller).
  template <typename Method, typename Request, typename Response>
  grpc::Status Call(Method method, const Request& request, Response* response,
                    std::chrono::milliseconds patience, Canceller& canceller) const {
    grpc::ClientContext context;
    const Canceller::Running running(canceller, context);
    if (const absl::Status status = Authorize(context); !status.ok()) {
      return {grpc::StatusCode::UNAUTHENTICATED, std::string(status.message())};
    }
    context.set_deadline(std::chrono::system_clock::now() + patience);
    return (stub_.get()->*method)(&context, request, response);
  }

 private:
  Connection(ServerAccess access, const std::shared_ptr<grpc::Channel>& channel);

  const ServerAccess access_;
  const std::shared_ptr<grpc::Channel> channel_;
  const std::unique_ptr<v1::ThunderheadService::Stub> stub_;
};

// Returns the delay before a retry that the server asks for in the details of an error; 0 if the
// error names no delay.
std::chrono::milliseconds RetryAfter(const grpc::Status& status);

}  // namespace thunderhead::client
