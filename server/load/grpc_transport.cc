#include <grpcpp/generic/generic_stub.h>
#include <grpcpp/grpcpp.h>
#include <grpcpp/support/proto_buffer_reader.h>

#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <deque>
#include <future>
#include <mutex>
#include <utility>

#include "absl/strings/str_cat.h"
#include "load/io_thread.h"
#include "load/pace.h"
#include "load/transport.h"

namespace thunderhead::load {
namespace {

namespace net = boost::asio;

constexpr char kGrpcService[] = "/thunderhead.v1.ThunderheadService/";

absl::Status FromGrpc(const grpc::Status& status) {
  return {static_cast<absl::StatusCode>(status.error_code()), status.error_message()};
}

grpc::ByteBuffer BufferOf(const std::string& message) {
  const grpc::Slice slice(message);
  return {&slice, 1};
}

std::shared_ptr<grpc::ChannelCredentials> CredentialsOf(const Access& access) {
  return access.tls_roots.empty() ? grpc::InsecureChannelCredentials()
                                  : grpc::SslCredentials({access.tls_roots, "", ""});
}

void ShowToken(const Access& access, grpc::ClientContext& context) {
  if (access.token.empty()) return;
  context.AddMetadata("authorization", absl::StrCat("Bearer ", access.token));
}

std::shared_ptr<grpc::Channel> Connect(const std::string& address, const Access& access) {
  grpc::ChannelArguments arguments;
  arguments.SetMaxReceiveMessageSize(-1);
  // Each channel gets a separate connection, as separate clients would have.
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
  return grpc::CreateCustomChannel(address, CredentialsOf(access), arguments);
}

// One call of Interact by gRPC. There is at most one pending read and one pending write. A hold
// keeps the call alive until reading has ended, because reads and writes are also started outside
// of gRPC's callbacks.
class GrpcLink final : public Link,
                       private grpc::ClientBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer> {
 public:
  GrpcLink(const std::string& address, const Access& access, net::io_context& io,
           Listener& listener, const LinkOptions& options)
      : listener_(listener),
        pace_(options.kbit_per_s),
        stub_(Connect(address, access)),
        reads_(options.reads),
        delay_(std::make_shared<net::steady_timer>(io)) {
    ShowToken(access, context_);
    stub_.PrepareBidiStreamingCall(&context_, absl::StrCat(kGrpcService, "Interact"), {}, this);
    AddHold();
    StartCall();
    if (reads_) StartRead(&received_);
  }

  ~GrpcLink() override { GrpcLink::Close(); }

  void Send(std::string message) override {
    const std::lock_guard lock(mutex_);
    if (released_ || half_closing_) return;
    unsent_.push_back(std::move(message));
    WriteNext();
  }

  void HalfClose() override {
    const std::lock_guard lock(mutex_);
    if (released_ || half_closing_) return;
    half_closing_ = true;
    WriteNext();
  }

  void Close() override {
    {
      const std::lock_guard lock(mutex_);
      cancelled_ = true;
      context_.TryCancel();
      if (!reads_) Release();
    }
    net::post(delay_->get_executor(), [delay = delay_] { delay->cancel(); });
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return done_; });
  }

 private:
  void OnReadDone(bool ok) override {
    if (!ok) {
      const std::lock_guard lock(mutex_);
      Release();
      return;
    }
    if (!pace_.IsLimited()) return Deliver();
    const auto delay = pace_.DelayOf(received_.Length(), Pace::Clock::now());
    net::post(delay_->get_executor(), [this, delay] { DeliverAfter(delay); });
  }

  void DeliverAfter(Pace::Clock::duration delay) {
    {
      const std::lock_guard lock(mutex_);
      delay_->expires_after(cancelled_ ? Pace::Clock::duration::zero() : delay);
    }
    delay_->async_wait([this](boost::system::error_code) { Deliver(); });
  }

  void Deliver() {
    const std::size_t bytes = received_.Length();
    {
      grpc::ProtoBufferReader reader(&received_);
      listener_.OnMessage(reader, bytes);
    }
    StartRead(&received_);
  }

  void OnWriteDone(bool ok) override {
    const std::lock_guard lock(mutex_);
    writing_ = false;
    if (!ok) unsent_.clear();
    WriteNext();
  }

  void OnDone(const grpc::Status& status) override {
    bool tell = false;
    {
      const std::lock_guard lock(mutex_);
      tell = !cancelled_;
    }
    if (tell) listener_.OnEnd(FromGrpc(status));
    const std::lock_guard lock(mutex_);
    done_ = true;
    changed_.notify_all();
  }

  // Writes the next message. The caller must hold mutex_.
  void WriteNext() {
    if (writing_ || released_) return;
    if (unsent_.empty()) {
      if (half_closing_ && !std::exchange(half_closed_, true)) StartWritesDone();
      return;
    }
    writing_ = true;
    sent_ = BufferOf(unsent_.front());
    unsent_.pop_front();
    StartWrite(&sent_);
  }

  // Releases the hold. The caller must hold mutex_.
  void Release() {
    if (!std::exchange(released_, true)) RemoveHold();
  }

  Listener& listener_;
  Pace pace_;
  grpc::GenericStub stub_;
  grpc::ClientContext context_;
  const bool reads_;
  grpc::ByteBuffer received_;
  grpc::ByteBuffer sent_;
  const std::shared_ptr<net::steady_timer> delay_;  // used only on the thread of its io_context

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::string> unsent_;
  bool writing_ = false;
  bool half_closing_ = false;
  bool half_closed_ = false;
  bool cancelled_ = false;
  bool released_ = false;  // true when no further reads and writes may start
  bool done_ = false;
};

class GrpcTransport final : public Transport {
 public:
  GrpcTransport(const std::string& address, const Access& access)
      : address_(address), access_(access), stub_(Connect(address, access)) {}

  std::string Name() const override { return "gRPC"; }

  std::unique_ptr<Link> Interact(Listener& listener, const LinkOptions& options) override {
    return std::make_unique<GrpcLink>(address_, access_, delays_.io(), listener, options);
  }

  absl::StatusOr<std::string> Call(const std::string& method, const std::string& request,
                                   const CallPatience& patience) override {
    grpc::ClientContext context;
    ShowToken(access_, context);
    context.set_deadline(std::chrono::system_clock::now() +
                         std::chrono::milliseconds(std::llround(1e3 * patience.seconds)));
    const grpc::ByteBuffer sent = BufferOf(request);
    grpc::ByteBuffer received;
    std::promise<grpc::Status> ended;
    stub_.UnaryCall(&context, absl::StrCat(kGrpcService, method), {}, &sent, &received,
                    [&](const grpc::Status& status) { ended.set_value(status); });
    const std::stop_callback stopping(patience.stop, [&context] { context.TryCancel(); });
    const grpc::Status status = ended.get_future().get();
    if (!status.ok()) return FromGrpc(status);
    grpc::Slice slice;
    if (const grpc::Status dumped = received.DumpToSingleSlice(&slice); !dumped.ok()) {
      return FromGrpc(dumped);
    }
    return std::string(reinterpret_cast<const char*>(slice.begin()), slice.size());
  }

 private:
  const std::string address_;
  const Access access_;
  grpc::GenericStub stub_;
  IoThread delays_;
};

}  // namespace

std::unique_ptr<Transport> MakeGrpcTransport(const std::string& address, const Access& access) {
  return std::make_unique<GrpcTransport>(address, access);
}

}  // namespace thunderhead::load
