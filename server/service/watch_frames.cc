#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <variant>

#include "base/error_details.h"
#include "base/status.h"
#include "rpc_port/delivery_deadline.h"
#include "rpc_port/finished.h"
#include "rpc_port/status_table.h"
#include "service/engine/frame_messages.h"
#include "service/handlers.h"
#include "service/messages/limits_check.h"
#include "service/messages/scene_messages.h"

namespace thunderhead::service {
namespace {

using FramesReactor = grpc::ServerWriteReactor<v1::WatchFramesResponse>;

// One viewer's stream. It lives until both gRPC and the hub have released it. There is at most one
// pending write. Finish is called once, while none is pending.
class FrameStream : public FramesReactor,
                    public delivery::Viewer,
                    public std::enable_shared_from_this<FrameStream> {
 public:
  // Starts a stream. The caller must have added the viewer to the session (Audience::AddOnlooker).
  static FramesReactor* Start(const Limits& limits, grpc::CallbackServerContext* context,
                              std::shared_ptr<session::Session> session, CallerRef caller) {
    auto stream =
        std::make_shared<FrameStream>(limits, context, std::move(session), std::move(caller));
    stream->held_by_grpc_ = stream;
    const auto viewer_id = stream->session_->hub().Join(stream);
    if (!viewer_id.ok()) {
      stream->caller_->ReportRefusal(viewer_id.status());
      stream->Finish(rpc_port::ToGrpcStatus(viewer_id.status()));
      return stream.get();
    }
    {
      const std::lock_guard lock(stream->mutex_);
      stream->viewer_id_ = *viewer_id;
    }
    stream->Wake();
    return stream.get();
  }

  FrameStream(const Limits& limits, grpc::CallbackServerContext* context,
              std::shared_ptr<session::Session> session, CallerRef caller)
      : session_(std::move(session)),
        caller_(std::move(caller)),
        delivery_(std::in_place, context, limits) {}

  void Wake() override {
    std::optional<delivery::FrameEvent> event;
    std::optional<grpc::Status> end;
    {
      const std::lock_guard lock(mutex_);
      if (viewer_id_ == 0 || writing_ || finished_) return;
      end = End();
      if (!end.has_value()) event = session_->hub().Take(viewer_id_);
      if (!end.has_value() && !event.has_value()) return;
      writing_ = event.has_value();
      finished_ = end.has_value();
    }
    if (end.has_value()) return Finish(*end);
    SetResponse(*event);
    delivery_->Begin(response_.ByteSizeLong());
    StartWrite(&response_);
  }

  void OnWriteDone(bool ok) override {
    delivery_->Taken();
    absl::Status known = ok ? caller_->StillKnown() : absl::OkStatus();
    {
      const std::lock_guard lock(mutex_);
      writing_ = false;
      disconnected_ = disconnected_ || !ok;
      known_ = std::move(known);
    }
    Wake();
  }

  void OnCancel() override {
    {
      const std::lock_guard lock(mutex_);
      disconnected_ = true;
    }
    Wake();
  }

  void OnDone() override {
    // Touch resets the session's idle time. It comes before the viewer leaves, because a session
    // without viewers has a shorter timeout and could expire at once.
    session_->Touch();
    if (viewer_id_ != 0) session_->hub().Leave(viewer_id_);
    session_->audience().RemoveOnlooker();
    // Ends the deadline here, because the hub may keep the stream alive for longer.
    delivery_.reset();
    held_by_grpc_.reset();
  }

 private:
  // Returns the status to end the stream with if it must end now. The caller must hold mutex_.
  std::optional<grpc::Status> End() {
    if (disconnected_) return grpc::Status(grpc::StatusCode::CANCELLED, "the viewer disconnected");
    if (!known_.ok()) return rpc_port::ToGrpcStatus(known_);
    const absl::Status closed = session_->hub().ClosedBecause();
    if (closed.ok()) return std::nullopt;
    return rpc_port::ToGrpcStatus(closed);
  }

  // Sets the response. Must be called while `writing_` is set, so that no other thread uses the
  // response.
  void SetResponse(const delivery::FrameEvent& event) {
    response_.set_viewer_id(viewer_id_);
    if (const auto* frame = std::get_if<std::shared_ptr<const delivery::EncodedFrame>>(&event)) {
      response_.clear_event();
      ToMessage(**frame, *response_.mutable_frame());
    } else {
      ToMessage(std::get<delivery::Problem>(event), *response_.mutable_problem());
    }
    SetScene();
  }

  void SetScene() {
    response_.clear_scene();
    response_.clear_scene_revision();
    const std::optional<session::NewestScene> newest = session_->Newest();
    if (!newest.has_value() || newest->revision == sent_revision_) return;
    sent_revision_ = newest->revision;
    response_.set_scene_revision(newest->revision);
    if (!response_.mutable_scene()->ParseFromString(*newest->serialized)) response_.clear_scene();
  }

  const std::shared_ptr<session::Session> session_;
  const CallerRef caller_;  // the stream counts towards the caller's quota while this exists
  std::shared_ptr<FrameStream> held_by_grpc_;
  v1::WatchFramesResponse response_;
  // The revision of the scene that was sent last. Like `response_`, it is used only while
  // `writing_` is set.
  std::uint64_t sent_revision_ = 0;
  std::mutex mutex_;
  std::uint64_t viewer_id_ = 0;
  bool writing_ = false;
  bool disconnected_ = false;
  absl::Status known_;  // reason why the caller may no longer watch; OK while it may
  bool finished_ = false;
  std::optional<rpc_port::DeliveryDeadline> delivery_;
};

// Returns the session, after adding the viewer to it (Audience::AddOnlooker).
absl::StatusOr<std::shared_ptr<session::Session>> FindToWatch(
    Engine& engine, const v1::WatchFramesRequest& request) {
  THUNDERHEAD_RETURN_IF_ERROR(CheckLimits(request));
  if (engine.drain.HasBegun()) return base::ShuttingDown();
  THUNDERHEAD_ASSIGN_OR_RETURN(const session::FoundSession found,
                               engine.sessions.Find(request.session_id()));
  const std::size_t most = engine.limits.max_viewers_per_session;
  if (!found.session->audience().AddOnlooker(found.role, most)) return TooManyViewers(most);
  return found.session;
}

}  // namespace

FramesReactor* WatchFrames(Engine& engine, grpc::CallbackServerContext* context, CallerRef caller,
                           const v1::WatchFramesRequest* request) {
  auto session = FindToWatch(engine, *request);
  if (!session.ok()) return new rpc_port::RefusedStream<FramesReactor>(*caller, session.status());
  return FrameStream::Start(engine.limits, context, *std::move(session), std::move(caller));
}

}  // namespace thunderhead::service
