#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/error_details.h"
#include "base/status.h"
#include "rpc_port/delivery_deadline.h"
#include "rpc_port/finished.h"
#include "rpc_port/status_table.h"
#include "service/jobs/job_messages.h"
#include "service/jobs/render_job_handlers.h"
#include "service/messages/limits_check.h"

namespace thunderhead::service {
namespace {

using JobReactor = grpc::ServerWriteReactor<v1::WatchRenderJobResponse>;

absl::Status Forgotten(const std::string& id) {
  return base::WithDetails(
      absl::NotFoundError(absl::StrCat("the render job '", id, "' was forgotten")),
      {.reason = "JOB_NOT_FOUND", .metadata = {{"job_id", id}}});
}

// One client's stream. There is at most one pending write, and changes during it are sent with the
// next one. It lives until both gRPC and the jobs have released it.
class JobStream final : public JobReactor,
                        public jobs::JobWatcher,
                        public std::enable_shared_from_this<JobStream> {
 public:
  JobStream(jobs::Jobs& jobs, const Limits& limits, grpc::CallbackServerContext* context,
            CallerRef caller, std::string id)
      : jobs_(jobs),
        caller_(std::move(caller)),
        id_(std::move(id)),
        delivery_(std::in_place, context, limits) {}

  static JobReactor* Start(jobs::Jobs& jobs, const Limits& limits,
                           grpc::CallbackServerContext* context, CallerRef caller,
                           const std::string& id) {
    auto stream = std::make_shared<JobStream>(jobs, limits, context, std::move(caller), id);
    const absl::Status known = jobs.Watch(id, AskerOf(*stream->caller_), stream);
    if (!known.ok()) return new rpc_port::RefusedStream<JobReactor>(*stream->caller_, known);
    stream->held_by_grpc_ = stream;
    stream->OnJobChanged();
    return stream.get();
  }

  void OnJobChanged() override {
    std::optional<grpc::Status> end;
    {
      const std::lock_guard lock(mutex_);
      if (writing_ || finished_) return;
      end = Next();
      writing_ = !end.has_value() && has_news_;
      finished_ = end.has_value();
      if (!writing_ && !finished_) return;
    }
    delivery_->Begin(end.has_value() ? 0 : response_.ByteSizeLong());
    if (end.has_value()) return Finish(*end);
    StartWrite(&response_);
  }

  void OnWriteDone(bool ok) override {
    delivery_->Taken();
    absl::Status known = ok ? caller_->StillKnown() : absl::OkStatus();
    {
      const std::lock_guard lock(mutex_);
      writing_ = false;
      memory_.reset();
      disconnected_ = disconnected_ || !ok;
      known_ = std::move(known);
    }
    OnJobChanged();
  }

  void OnCancel() override {
    {
      const std::lock_guard lock(mutex_);
      disconnected_ = true;
    }
    OnJobChanged();
  }

  void OnDone() override {
    // Ends the deadline here, because the jobs may keep the stream alive for longer.
    delivery_.reset();
    held_by_grpc_.reset();
  }

 private:
  // Returns the status with which the stream ends now. If it continues, sets the response to the
  // changes since the last message, if any. The caller must hold mutex_.
  std::optional<grpc::Status> Next() {
    if (disconnected_) return grpc::Status(grpc::StatusCode::CANCELLED, "the client disconnected");
    if (!known_.ok()) return rpc_port::ToGrpcStatus(known_);
    const absl::StatusOr<std::optional<jobs::JobNews>> news = jobs_.NewsOf(id_, sent_version_);
    if (!news.ok()) return rpc_port::ToGrpcStatus(news.status());
    if (!news->has_value()) return rpc_port::ToGrpcStatus(Forgotten(id_));
    has_news_ = (*news)->version != sent_version_;
    if (!has_news_) return has_ended_ ? std::optional(grpc::Status::OK) : std::nullopt;
    sent_version_ = (*news)->version;
    has_ended_ = (*news)->job.ended_at.has_value();
    response_.Clear();
    ToMessage((*news)->job, *response_.mutable_job());
    for (const jobs::PictureView& picture : (*news)->pictures) {
      ToMessage(picture, *response_.add_pictures());
    }
    auto memory = caller_->TakeUnread(rpc_port::UnreadBytes(response_));
    if (!memory.ok()) return rpc_port::ToGrpcStatus(memory.status());
    memory_ = *std::move(memory);
    return std::nullopt;
  }

  jobs::Jobs& jobs_;
  const CallerRef caller_;  // the stream counts towards the caller's quota while this exists
  const std::string id_;
  std::shared_ptr<JobStream> held_by_grpc_;
  v1::WatchRenderJobResponse response_;  // gRPC reads it while `writing_` is set
  std::shared_ptr<const void> memory_;   // that of the response, while it is being written
  std::mutex mutex_;
  std::uint64_t sent_version_ = 0;
  bool has_news_ = false;
  bool has_ended_ = false;
  bool writing_ = false;
  bool disconnected_ = false;
  absl::Status known_;  // reason why the caller may no longer watch; OK while it may
  bool finished_ = false;
  std::optional<rpc_port::DeliveryDeadline> delivery_;
};

}  // namespace

JobReactor* WatchRenderJob(jobs::Jobs& jobs, const Limits& limits,
                           grpc::CallbackServerContext* context, CallerRef caller,
                           const v1::WatchRenderJobRequest* request) {
  if (const absl::Status wrong = CheckLimits(*request); !wrong.ok()) {
    return new rpc_port::RefusedStream<JobReactor>(*caller, wrong);
  }
  return JobStream::Start(jobs, limits, context, std::move(caller), request->job_id());
}

}  // namespace thunderhead::service
