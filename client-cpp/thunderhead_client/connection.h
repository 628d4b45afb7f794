// A connection to one server: address, encryption and token. What a call needs besides its
// messages.
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
  std::string address;      // HOST:PORT of the server's gRPC port
  std::string tls_ca_file;  // PEM of who vouches for its certificate; empty: no encryption
  std::string token_file;   // a bearer token, read again for each call; empty: none
  // Sends the token without encryption to other machines, too, where anybody on the way can read
  // it.
  bool allow_plaintext_token = false;
};

// Ends unary calls from another thread: whoever makes calls can be destroyed without waiting for a
// server that does not answer.
class Canceller {
 public:
  // Cancels what runs; every later call ends at once.
  void Cancel();

 private:
  friend class Connection;
  class Running;

  std::mutex mutex_;
  bool cancelled_ = false;
  std::set<grpc::ClientContext*> running_;
};

// A call of a canceller, while it runs.
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
  // Connects at the first call. An error names the file that cannot be read or is no PEM, or the
  // address that is none.
  static absl::StatusOr<std::shared_ptr<Connection>> Open(ServerAccess access);

  v1::ThunderheadService::Stub& stub() const { return *stub_; }
  const std::string& address() const { return access_.address; }

  // Waits for a server that was reached before, or could not be, for some seconds at most or until
  // `gives_up`, which is asked ten times a second. A call that comes at once fails with the
  // channel's last failure, and while nothing waits on a channel gRPC works on it only every five
  // seconds.
  void AwaitReconnection(const std::function<bool()>& gives_up) const;

  // For people: why a call failed. The server's own words, or, where none has answered, what may
  // be wrong and what to try.
  std::string Explain(const grpc::Status& status) const;

  // Adds the token. An error if its file cannot be read.
  absl::Status Authorize(grpc::ClientContext& context) const;

  // Calls one unary rpc: Call(&Stub::ListStorms, request, &response, patience, canceller).
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

// The delay that the server asks for in the details of a refusal; 0 if it names none.
std::chrono::milliseconds RetryAfter(const grpc::Status& status);

}  // namespace thunderhead::client
