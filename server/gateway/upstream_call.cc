#include "gateway/upstream_call.h"

#include <boost/asio/post.hpp>
#include <map>
#include <string>
#include <string_view>

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
    : executor_(executor),
      work_(net::make_work_guard(executor)),
      changed_(executor, net::steady_timer::time_point::max()) {}

UpstreamCall::Lease UpstreamCall::Start(grpc::GenericStub& stub,
                                        const net::any_io_executor& executor,
                                        const UpstreamRequest& request) {
  std::shared_ptr<UpstreamCall> call(new UpstreamCall(executor));
  for (const auto& [name, value] : request.metadata) call->context_.AddMetadata(name, value);
  if (request.deadline.has_value()) call->context_.set_deadline(*request.deadline);
  const grpc::Slice slice(request.message.data(), request.message.size());
  call->request_ = grpc::ByteBuffer(&slice, 1);

  // On the wire a unary or server-streaming call is a bidirectional one that writes a single
  // message.
  stub.PrepareBidiStreamingCall(&call->context_, request.method, {}, call.get());
  call->self_ = call;
  // Reads start outside gRPC's callbacks, which requires a hold until the last of them.
  call->AddHold();
  // gRPC 1.51's in-process transport never ends the server's side of a call whose handler sends a
  // message together with its status, as unary ones do, while no read is pending. So the first read
  // starts before the call.
  call->StartRead(&call->message_);
  call->StartWriteLast(&call->request_, grpc::WriteOptions());
  call->StartCall();
  return Lease(std::move(call));
}

net::awaitable<bool> UpstreamCall::AwaitHeaders() {
  co_await AwaitTrue(headers_known_);
  co_return has_headers_;
}

net::awaitable<std::optional<grpc::ByteBuffer>> UpstreamCall::ReadMessage() {
  if (!is_first_read_) {
    read_known_ = false;
    StartRead(&message_);
  }
  is_first_read_ = false;
  co_await AwaitTrue(read_known_);
  if (!has_message_) {
    at_end_ = true;
    co_return std::nullopt;
  }
  std::optional<grpc::ByteBuffer> message(std::in_place);
  message->Swap(&message_);
  co_return message;
}

net::awaitable<grpc::Status> UpstreamCall::Finish() {
  // Trailers alone leave nothing to read, and cancelling might hide their status.
  if (at_end_ || !has_headers_) {
    if (!released_) {
      released_ = true;
      RemoveHold();
    }
  } else {
    Release();
  }
  co_await AwaitTrue(done_);
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

void UpstreamCall::OnDone(const grpc::Status& status) {
  PostChange([status](UpstreamCall& call) {
    call.done_ = true;
    call.status_ = status;
    call.self_.reset();
  });
}

net::awaitable<void> UpstreamCall::AwaitTrue(const bool& condition) {
  while (!condition) {
    boost::system::error_code woken;
    co_await changed_.async_wait(net::redirect_error(net::use_awaitable, woken));
  }
}

// gRPC calls back on threads of its own.
template <typename Change>
void UpstreamCall::PostChange(Change change) {
  net::post(executor_, [self = self_, change = std::move(change)] {
    change(*self);
    self->changed_.cancel();
  });
}

void UpstreamCall::Release() {
  if (released_) return;
  released_ = true;
  context_.TryCancel();
  RemoveHold();
}

}  // namespace thunderhead::gateway
