// One call to the gRPC server, used on the thread of an executor. The user starts it, writes
// messages, reads messages one at a time, and awaits its end. Messages are bytes: the call is
// independent of their types and of HTTP.
#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/executor_work_guard.hpp>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "gateway/awaitable.h"
#include "gateway/change_signal.h"
#include "gateway/grpc_web_protocol.h"
#include "grpcpp/client_context.h"
#include "grpcpp/generic/generic_stub.h"
#include "grpcpp/support/byte_buffer.h"
#include "grpcpp/support/client_callback.h"
#include "grpcpp/support/status.h"

namespace thunderhead::gateway {

struct UpstreamRequest {
  std::string method;  // "/package.Service/Method"
  Metadata metadata;
  std::optional<std::chrono::system_clock::time_point> deadline;
  // The message of a unary or server-streaming call. If absent, messages are written with
  // BeginWrite(), until BeginHalfClose().
  std::optional<std::string_view> only_message;
};

class UpstreamCall : private grpc::ClientBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer> {
 public:
  // A handle that ends its call when it is destroyed, so that no call outlives its connection.
  class Lease {
   public:
    explicit Lease(std::shared_ptr<UpstreamCall> call) : call_(std::move(call)) {}
    Lease(const Lease&) = delete;
    Lease& operator=(const Lease&) = delete;
    ~Lease() { call_->Release(); }
    UpstreamCall* operator->() const { return call_.get(); }
    // Returns a reference to the call, for code that may have to cancel the call after the lease
    // was destroyed.
    std::shared_ptr<UpstreamCall> Share() const { return call_; }

   private:
    std::shared_ptr<UpstreamCall> call_;
  };

  // Starts a call. All its methods run on `executor`, which must have only one thread.
  static Lease Start(grpc::GenericStub& stub, const boost::asio::any_io_executor& executor,
                     const UpstreamRequest& request);

  // Waits for the server's headers. Returns false if the server sent only trailers.
  boost::asio::awaitable<bool> AwaitHeaders();
  // Reads the server's next message. Returns nothing after the last message.
  boost::asio::awaitable<std::optional<grpc::ByteBuffer>> ReadMessage();

  // Begin to write a message, or to end the writing, without waiting. Before each call of either
  // function, AwaitWritten() must have returned since the last one.
  void BeginWrite(grpc::ByteBuffer message);
  void BeginHalfClose();
  // Waits until gRPC has accepted the last write. gRPC's flow control delays this while the server
  // does not read. Returns false if the call accepts no further writes.
  boost::asio::awaitable<bool> AwaitWritten();

  // Returns the call's outcome. Cancels the call if not all messages were read.
  boost::asio::awaitable<grpc::Status> Finish();

  // Return metadata encoded for the wire. InitialMetadata is valid after AwaitHeaders(),
  // TrailingMetadata after Finish().
  Metadata InitialMetadata() const;
  Metadata TrailingMetadata() const;

  void Cancel() { context_.TryCancel(); }

 private:
  explicit UpstreamCall(const boost::asio::any_io_executor& executor);

  void OnReadInitialMetadataDone(bool ok) override;
  void OnReadDone(bool ok) override;
  void OnWriteDone(bool ok) override;
  void OnWritesDoneDone(bool ok) override;
  void OnDone(const grpc::Status& status) override;

  void WriteOnly(std::string_view message);
  template <typename Change>
  void PostChange(Change change);
  void Release();

  boost::asio::any_io_executor executor_;
  // Keeps the executor running until gRPC has released the call.
  boost::asio::executor_work_guard<boost::asio::any_io_executor> work_;
  ChangeSignal changed_;
  std::shared_ptr<UpstreamCall> self_;  // held until gRPC has released the call
  grpc::ClientContext context_;
  grpc::ByteBuffer request_;
  grpc::ByteBuffer message_;

  // The following members are written and read only on the executor.
  bool headers_known_ = false;
  bool has_headers_ = false;
  bool is_first_read_ = true;
  bool read_known_ = false;
  bool has_message_ = false;
  bool at_end_ = false;
  bool written_ = true;  // true while no write is pending
  bool accepts_writes_ = true;
  bool done_ = false;
  bool released_ = false;
  grpc::Status status_;
};

}  // namespace thunderhead::gateway
