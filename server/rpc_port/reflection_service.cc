#include "rpc_port/reflection_service.h"

#include <utility>

#include "absl/status/status.h"
#include "base/error_details.h"
#include "base/guarded.h"
#include "rpc_port/delivery_deadline.h"
#include "rpc_port/finished.h"
#include "rpc_port/status_table.h"

namespace thunderhead::rpc_port {
namespace {

// Maximum number of open calls of the whole server.
constexpr int kMostOpen = 16;

absl::Status TooManyOpen() {
  return base::WithDetails(
      absl::ResourceExhaustedError("too many reflection calls are open; end one, or try later"),
      {.reason = "TOO_MANY_REFLECTION_CALLS"});
}

std::vector<std::string> WithReflection(std::vector<std::string> services) {
  services.emplace_back(grpc::reflection::v1alpha::ServerReflection::service_full_name());
  return services;
}

// One client's call. It reads a request and writes its answer in turn, so it never has two pending
// operations. It deletes itself when gRPC calls OnDone.
class ReflectionCall final : public ReflectionService::Reactor {
 public:
  // `open`, which counts this call already, is decremented when the call has ended.
  ReflectionCall(grpc::CallbackServerContext* context, const PortLimits& limits,
                 const ReflectedServices& services, std::atomic<int>& open)
      : services_(services), open_(open), delivery_(context, limits) {
    ReadNext();
  }

  void OnReadDone(bool ok) override {
    if (!ok) return Finish(grpc::Status::OK);
    const absl::Status answered = base::Guarded([this] {
      services_.Answer(request_, response_);
      return absl::OkStatus();
    });
    if (!answered.ok()) return Finish(ToGrpcStatus(answered));
    delivery_.Begin(response_.ByteSizeLong());
    StartWrite(&response_);
  }

  void OnWriteDone(bool ok) override {
    if (!ok) return Finish({grpc::StatusCode::CANCELLED, "the client is gone"});
    ReadNext();
  }

  void OnDone() override {
    --open_;
    delete this;
  }

 private:
  // The next request has the deadline of an answer without bytes.
  void ReadNext() {
    delivery_.Begin(0);
    StartRead(&request_);
  }

  const ReflectedServices& services_;
  std::atomic<int>& open_;
  ReflectedServices::Request request_;
  ReflectedServices::Response response_;
  DeliveryDeadline delivery_;
};

}  // namespace

ReflectionService::ReflectionService(const PortLimits& limits, std::vector<std::string> services)
    : limits_(limits), services_(WithReflection(std::move(services))) {}

ReflectionService::Reactor* ReflectionService::ServerReflectionInfo(
    grpc::CallbackServerContext* context) {
  if (++open_ > kMostOpen) {
    --open_;
    return new RefusedStream<Reactor>(TooManyOpen());
  }
  return new ReflectionCall(context, limits_, services_, open_);
}

}  // namespace thunderhead::rpc_port
