#include "gateway/upstream_call.h"

#include <boost/asio/post.hpp>
#include <map>
#include <string>
#include <string_view>

#include "base/status.h"
#include "grpcpp/support/slice.h"

namespace thunderhead::gateway {
namespace {

namespace net = boost::asio;

Metadata ForBrowser(const std::multimap<grpc::string_ref, grpc::string_ref>& received) {
  Metadata metadata;
  for (const auto& [key, value] : received) {
    const std::string name(key.data(), key.size());
    if (IsForwardedToBrowser(name)) {
      metadata.emplace_back(name, EncodeValue(name, std::string_view(value.data(), value.size())));
    }
  }
  return metadata;
}

}  // namespace

UpstreamCall::UpstreamCall(const net::any_io_executor& executor)
    : executor_(executor), work_(net::make_work_guard(executor)), changed_(executor) {}

UpstreamCall::Lease UpstreamCall::Start(grpc::GenericStub& stub,
                                        const net::any_io_executor& executor,
                                        const UpstreamRequest& request) {
  std::shared_ptr<UpstreamCall> call(new UpstreamCall(executor));
  for (const auto& [name, value] : request.metadata) call->context_.AddMetadata(name, value);
  if (request.deadline.has_value()) call->context_.set_deadline(*request.deadline);

  // Every call is bidirectional on the wire. A unary or server-streaming call writes a single
  // message.
  stub.PrepareBidiStreamingCall(&call->context_, request.method, {}, call.get());
  call->self_ = call;
  // The hold is required because reads are started outside gRPC's callbacks. It lasts until the
  // last read.
  call->AddHold();
  // In gRPC 1.51's in-process transport, a handler may send a message together with its status, as
  // unary handlers do. The server's side of such a call never ends while the client has no pending
  // read. So the first read is started before the call.
  call->StartRead(&call->message_);
  if (request.only_message.has_value()) call->WriteOnly(*request.only_message);
  call->StartCall();
  return Lease(std::move(call));
}

net::awaitable<bool> UpstreamCall::AwaitHeaders() {
  co_await changed_.AwaitTrue(headers_known_);
  co_return has_headers_;
}

net::awaitable<std::optional<grpc::ByteBuffer>> UpstreamCall::ReadMessage() {
  if (!is_first_read_) {
    read_known_ = false;
    StartRead(&message_);
  }
  is_first_read_ = false;
  co_await changed_.AwaitTrue(read_known_);
  if (!has_message_) {
    at_end_ = true;
    co_return std::nullopt;
  }
  std::optional<grpc::ByteBuffer> message(std::in_place);
  message->Swap(&message_);
  co_return message;
}

void UpstreamCall::WriteOnly(std::string_view message) {
  const grpc::Slice slice(message.data(), message.size());
  request_ = grpc::ByteBuffer(&slice, 1);
  written_ = false;
  accepts_writes_ = false;
  StartWriteLast(&request_, grpc::WriteOptions());
}

void UpstreamCall::BeginWrite(grpc::ByteBuffer message) {
  THUNDERHEAD_CHECK(written_, "a message was written while gRPC had not taken the one before");
  if (released_ || !accepts_writes_) return;
  request_.Swap(&message);
  written_ = false;
  StartWrite(&request_);
}

void UpstreamCall::BeginHalfClose() {
  THUNDERHEAD_CHECK(written_, "writing was ended while gRPC had not taken the last message");
  if (released_ || !accepts_writes_) return;
  accepts_writes_ = false;
  written_ = false;
  StartWritesDone();
}

net::awaitable<bool> UpstreamCall::AwaitWritten() {
  co_await changed_.AwaitTrue(written_);
  co_return accepts_writes_;
}

net::awaitable<grpc::Status> UpstreamCall::Finish() {
  // If the server sent only trailers, there is nothing to read, and cancelling might hide the
  // status in them.
  if (at_end_ || !has_headers_) {
    if (!released_) {
      released_ = true;
      RemoveHold();
    }
  } else {
    Release();
  }
  co_await changed_.AwaitTrue(done_);
  co_return status_;
}

Metadata UpstreamCall::InitialMetadata() const {
  if (!has_headers_) return {};
  return ForBrowser(context_.GetServerInitialMetadata());
}

Metadata UpstreamCall::TrailingMetadata() const {
  return ForBrowser(context_.GetServerTrailingMetadata());
}

void UpstreamCall::OnReadInitialMetadataDone(bool ok) {
  PostChange([ok](UpstreamCall& call) {
    call.headers_known_ = true;
    call.has_headers_ = ok;
  });
}

void UpstreamCall::OnReadDone(bool ok) {
  PostChange([ok](UpstreamCall& call) {
    call.read_known_ = true;
    call.has_message_ = ok;
  });
}

void UpstreamCall::OnWriteDone(bool ok) {
  PostChange([ok](UpstreamCall& call) {
    call.written_ = true;
    call.accepts_writes_ = call.accepts_writes_ && ok;
    call.request_.Clear();
  });
}

void UpstreamCall::OnWritesDoneDone(bool) {
  PostChange([](UpstreamCall& call) { call.written_ = true; });
}

void UpstreamCall::OnDone(const grpc::Status& status) {
  PostChange([status](UpstreamCall& call) {
    call.done_ = true;
    call.status_ = status;
    call.self_.reset();
  });
}

// gRPC calls back on its own threads, so the change is posted to the executor.
template <typename Change>
void UpstreamCall::PostChange(Change change) {
  net::post(executor_, [self = self_, change = std::move(change)] {
    change(*self);
    self->changed_.Notify();
  });
}

void UpstreamCall::Release() {
  if (released_) return;
  released_ = true;
  context_.TryCancel();
  RemoveHold();
}

}  // namespace thunderhead::gateway
