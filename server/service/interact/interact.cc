#include "service/interact/interact.h"

#include <grpcpp/alarm.h>
#include <grpcpp/support/proto_buffer_reader.h>

#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <variant>

#include "absl/strings/str_cat.h"
#include "access/rules.h"
#include "base/error_details.h"
#include "base/guarded.h"
#include "base/status.h"
#include "rpc_port/alarm_time.h"
#include "rpc_port/delivery_deadline.h"
#include "rpc_port/status_table.h"
#include "service/engine/catalogue_follower.h"
#include "service/engine/frame_messages.h"
#include "service/interact/interact_messages.h"
#include "service/interact/interact_requests.h"
#include "service/interact/person_requests.h"
#include "service/interact/untold_news.h"
#include "service/messages/limits_check.h"

namespace thunderhead::service {
namespace {

using session::Clock;

// Maximum number of answers that wait for a slow client. At this number, no further request is
// read.
constexpr std::size_t kMaxWaitingAnswers = 16;
// The time between two checks of the token of a client that sends nothing.
constexpr std::chrono::seconds kTokenPeriod{2};

absl::Status NotJoined() {
  return base::InvalidField("join", "is missing; it must be the first message, and only the first",
                            "NOT_JOINED");
}

absl::Status JoinedTooLate(std::chrono::milliseconds limit) {
  return base::WithDetails(
      absl::DeadlineExceededError(absl::StrCat("the client sent no Join within ", limit.count(),
                                               " ms; send it as the first message")),
      {.reason = "NOT_JOINED"});
}

absl::Status Replaced() {
  return base::WithDetails(
      absl::AbortedError("this connection did not answer CheckAlive, so another one with its "
                         "participant_key replaced it; join again"),
      {.reason = "CONNECTION_REPLACED"});
}

// Returns the name of a request that is always written to the audit log, or null for other
// requests.
const char* PrivilegedAct(const v1::InteractRequest& request) {
  switch (request.message_case()) {
    case v1::InteractRequest::kGiveControl:
      return "GiveControl";
    case v1::InteractRequest::kTakeControl:
      return "TakeControl";
    case v1::InteractRequest::kSetRules:
      return "SetRules";
    default:
      return nullptr;
  }
}

// Returns a name such as "Interact/update_scene".
std::string NameOfRequest(const v1::InteractRequest& request) {
  const auto* const field =
      v1::InteractRequest::descriptor()->FindFieldByNumber(request.message_case());
  return absl::StrCat("Interact/", field == nullptr ? "unknown" : field->name());
}

// One client's call. It lives until gRPC, the session and the pending requests have released it.
// There is at most one pending read and one pending write. Finish is called once, while nothing is
// being written. The thread that completes a read handles the request, so requests are handled one
// after another. The next message is chosen only when the last write is done, so that the newest
// state is sent.
class InteractCall : public InteractReactor,
                     public Asker,
                     public std::enable_shared_from_this<InteractCall> {
 public:
  static InteractReactor* Start(Engine& engine, grpc::CallbackServerContext* context,
                                std::shared_ptr<const access::Caller> caller,
                                double requests_per_second) {
    auto call =
        std::make_shared<InteractCall>(engine, context, std::move(caller), requests_per_second);
    call->held_by_grpc_ = call;
    {
      const std::lock_guard lock(call->mutex_);
      call->SetAlarm(call->join_due_);
    }
    call->StartRead(&call->received_);
    return call.get();
  }

  InteractCall(Engine& engine, grpc::CallbackServerContext* context,
               std::shared_ptr<const access::Caller> caller, double requests_per_second)
      : engine_(engine),
        caller_(std::move(caller)),
        budget_(requests_per_second, engine.limits.time->Now()),
        join_due_(engine.limits.time->Now() + engine.limits.join_timeout),
        delivery_(std::in_place, context, engine.limits) {}

  // Writes the next message, or ends the call if there is a reason to end it. Does nothing while a
  // message is being written.
  void Wake() override {
    std::optional<grpc::ByteBuffer> message;
    std::optional<grpc::Status> end;
    {
      const std::lock_guard lock(mutex_);
      if (writing_ || finished_) return;
      end = Ended();
      if (!end.has_value()) message = Next();
      if (!end.has_value() && !message.has_value()) return;
      writing_ = message.has_value();
      finished_ = end.has_value();
      if (message.has_value()) sent_.Swap(&*message);
    }
    if (end.has_value()) return Finish(*end);
    delivery_->Begin(sent_.Length());
    StartWrite(&sent_);
  }

  void OnReadDone(bool ok) override {
    if (!ok) return End(grpc::Status::OK);
    const absl::Status status = base::Guarded([this] { return Handle(); });
    if (!status.ok()) return End(rpc_port::ToGrpcStatus(status));
    {
      const std::lock_guard lock(mutex_);
      reading_ = false;
    }
    ReadOn();
  }

  void OnWriteDone(bool ok) override {
    delivery_->Taken();
    std::optional<std::uint64_t> doubts;
    {
      const std::lock_guard lock(mutex_);
      writing_ = false;
      doubts = std::exchange(asking_for_, std::nullopt);
      if (!ok) end_ = grpc::Status(grpc::StatusCode::CANCELLED, "the client is gone");
    }
    if (ok && doubts.has_value()) {
      session_->audience().Checked(person_id_, *doubts, session_->Now());
    }
    ReadOn();
    Wake();
  }

  void Await() override {
    const std::lock_guard lock(mutex_);
    ++updates_;
  }

  void Settle(const std::optional<v1::InteractResponse>& answer) override {
    {
      const std::lock_guard lock(mutex_);
      --updates_;
    }
    if (answer.has_value()) return Answer(*answer);
    ReadOn();
  }

  void OnCancel() override {
    End(grpc::Status(grpc::StatusCode::CANCELLED, "the client cancelled the call"));
  }

  void OnDone() override {
    if (session_ != nullptr) {
      // Touch resets the session's idle time. It comes before the viewer leaves, because a session
      // without viewers has a shorter timeout and could expire at once.
      session_->Touch();
      {
        const std::lock_guard lock(mutex_);
        Watch(nullptr);
      }
      session_->audience().Leave(person_id_, session_->Now());
    }
    // Ends the deadline here, because the session and pending requests may keep the call alive for
    // longer.
    delivery_.reset();
    held_by_grpc_.reset();
  }

 private:
  // Sets the alarm for the next check of the client (Look). The caller must hold mutex_.
  void SetAlarm(Clock::time_point due) {
    alarm_.emplace().Set(rpc_port::AlarmTime(*engine_.limits.time, due),
                         [weak = weak_from_this()](bool rang) {
                           const auto self = weak.lock();
                           if (rang && self != nullptr) self->Look();
                         });
  }

  // Ends the call if its client has not joined in time, or if the token of a client that has joined
  // has expired or was removed. The alarm checks even clients that only receive and send no
  // requests.
  void Look() {
    bool has_joined = false;
    {
      const std::lock_guard lock(mutex_);
      if (finished_) return;
      has_joined = session_ != nullptr;
    }
    if (!has_joined) return LookForJoin();
    const absl::Status known = caller_->StillKnown();
    if (!known.ok()) return End(rpc_port::ToGrpcStatus(known));
    const std::lock_guard lock(mutex_);
    if (!finished_) SetAlarm(engine_.limits.time->Now() + kTokenPeriod);
  }

  // Ends the call if its client has not joined in time.
  void LookForJoin() {
    {
      const std::lock_guard lock(mutex_);
      if (session_ != nullptr || finished_) return;
      if (engine_.limits.time->Now() < join_due_) return SetAlarm(join_due_);
    }
    const absl::Status status = JoinedTooLate(engine_.limits.join_timeout);
    caller_->Report("Interact/join", status);
    End(rpc_port::ToGrpcStatus(status));
  }

  // Ends the call as soon as nothing is being written. The first reason is kept.
  void End(const grpc::Status& status) {
    {
      const std::lock_guard lock(mutex_);
      if (!end_.has_value()) end_ = status;
    }
    Wake();
  }

  // Returns the status with which the call must end now; nothing if it continues. The caller must
  // hold mutex_.
  std::optional<grpc::Status> Ended() {
    if (end_.has_value()) return end_;
    if (session_ == nullptr) return std::nullopt;
    if (!session_->audience().IsThere(person_id_)) return rpc_port::ToGrpcStatus(Replaced());
    if (!end_told_) return std::nullopt;
    return rpc_port::ToGrpcStatus(session_->hub().ClosedBecause());
  }

  // Returns the next message, if there is one. The caller must hold mutex_.
  std::optional<grpc::ByteBuffer> Next() {
    if (!answers_.empty()) {
      grpc::ByteBuffer answer = answers_.front();
      answers_.pop_front();
      return answer;
    }
    if (session_ == nullptr) return std::nullopt;
    if (const absl::Status closed = session_->hub().ClosedBecause(); !closed.ok()) {
      end_told_ = true;
      return ResponseOf(EndResponse(closed));
    }
    if (!drain_told_ && engine_.drain.HasBegun()) {
      drain_told_ = true;
      return ResponseOf(EndResponse(base::ShuttingDown()));
    }
    if (const std::uint64_t doubts = session_->audience().Doubts(person_id_);
        doubts != told_doubts_) {
      told_doubts_ = doubts;
      asking_for_ = doubts;
      v1::InteractResponse response;
      response.mutable_check_alive();
      return ResponseOf(response);
    }
    Watch(Watched());
    // News (changes other than frames) and frames alternate, so that neither delays the other on a
    // slow link.
    const auto next_news = [&] { return news_->Next(*session_, engine_.catalogue); };
    std::optional<grpc::ByteBuffer> next = frame_next_ ? NextFrame() : next_news();
    if (!next.has_value()) next = frame_next_ ? next_news() : NextFrame();
    frame_next_ = !frame_next_;
    return next;
  }

  std::optional<grpc::ByteBuffer> NextFrame() {
    if (watched_ == nullptr) return std::nullopt;
    const auto event = watched_->hub().Take(watcher_id_);
    if (!event.has_value()) return std::nullopt;
    if (const auto* frame = std::get_if<std::shared_ptr<const delivery::EncodedFrame>>(&*event)) {
      return FrameResponse(*frame, watched_ != session_);
    }
    v1::InteractResponse response;
    ToMessage(std::get<delivery::Problem>(*event), *response.mutable_problem());
    response.mutable_problem()->set_own_view(watched_ != session_);
    return ResponseOf(response);
  }

  // Returns the session that draws the person's frames: the joined session, the person's own view,
  // or null. The caller must hold mutex_.
  std::shared_ptr<session::Session> Watched() {
    const std::shared_ptr<session::Session> own_view = requests_->OwnView();
    if (hidden_) return nullptr;
    return own_view == nullptr ? session_ : own_view;
  }

  // Subscribes to the frames of `session`. The caller must hold mutex_.
  void Watch(const std::shared_ptr<session::Session>& session) {
    if (session == watched_) return;
    if (watched_ != nullptr) watched_->hub().Leave(watcher_id_);
    watched_ = nullptr;
    if (session == nullptr) return;
    const auto watcher_id = session->hub().Join(shared_from_this(), wants_);
    if (!watcher_id.ok()) return;  // the session has closed; the next message reports this
    watched_ = session;
    watcher_id_ = *watcher_id;
  }

  // Reads the next request, unless too many answers are waiting.
  void ReadOn() {
    // The read is started under the lock. Otherwise the call could be finished before the read has
    // started, because there would be no pending read or write to prevent that.
    const std::lock_guard lock(mutex_);
    if (reading_ || finished_ || answers_.size() + updates_ >= kMaxWaitingAnswers) return;
    reading_ = true;
    StartRead(&received_);
  }

  void Answer(const v1::InteractResponse& response) {
    {
      const std::lock_guard lock(mutex_);
      answers_.push_back(ResponseOf(response));
    }
    Wake();
  }

  // Handles the received request. A refused request gets an answer. Only a returned error ends the
  // call.
  absl::Status Handle() {
    v1::InteractRequest request;
    grpc::ProtoBufferReader reader(&received_);
    const bool parsed = request.ParseFromZeroCopyStream(&reader) && reader.status().ok();
    if (!parsed) {
      return base::InvalidField("message", "is not an InteractRequest", "MESSAGE_UNREADABLE");
    }
    if (session_ == nullptr) {
      absl::Status joined = Join(request);
      if (!joined.ok()) caller_->Report("Interact/join", joined);
      return joined;
    }
    THUNDERHEAD_RETURN_IF_ERROR(caller_->StillKnown());
    session_->Touch();
    session_->audience().Heard(person_id_);
    absl::Status status = budget_.Take(engine_.limits.time->Now());
    if (status.ok()) status = CheckLimits(request);
    if (status.ok()) status = Obey(request);
    if (const char* act = PrivilegedAct(request); act != nullptr) {
      caller_->Report(act, status);
    } else {
      caller_->ReportRefusal(NameOfRequest(request), status);
    }
    if (!status.ok()) Answer(RefusedResponse(request.request_id(), status));
    return absl::OkStatus();
  }

  absl::Status Join(const v1::InteractRequest& request) {
    if (!request.has_join()) return NotJoined();
    if (engine_.drain.HasBegun()) return base::ShuttingDown();
    THUNDERHEAD_RETURN_IF_ERROR(CheckLimits(request));
    const v1::Join& join = request.join();
    THUNDERHEAD_ASSIGN_OR_RETURN(const std::string name, NameOf(join.name(), "join.name"));
    THUNDERHEAD_ASSIGN_OR_RETURN(std::string participant_key,
                                 ParticipantKeyOf(join.participant_key(), "join.participant_key"));
    THUNDERHEAD_ASSIGN_OR_RETURN(const session::FoundSession found,
                                 engine_.sessions.Find(join.session_key()));
    // A viewer token never grants presenter rights, even with a presenter key.
    const session::Role role =
        access::MayPresent(caller_->identity().role) ? found.role : session::Role::kViewer;
    const std::size_t most = engine_.limits.max_viewers_per_session;
    const std::optional<std::uint64_t> person_id =
        found.session->audience().Join(role, name, shared_from_this(), found.session->Now(), most,
                                       participant_key, join.answers_checks());
    if (!person_id.has_value()) return TooManyViewers(most);
    v1::InteractResponse response;
    v1::Joined& joined = *response.mutable_joined();
    joined.set_viewer_id(*person_id);
    joined.set_role(RoleMessage(role));
    joined.set_viewer_key(found.session->keys().viewer);
    joined.set_participant_key(participant_key);
    {
      const std::lock_guard lock(mutex_);
      person_id_ = *person_id;
      answers_.push_back(ResponseOf(response));
      hidden_ = join.window().hidden();
      for (const int codec : join.codecs()) {
        takes_video_ = takes_video_ || codec == v1::CODEC_VP9;
        takes_resting_frames_ = takes_resting_frames_ || codec == v1::CODEC_AVIF;
      }
      wants_ = WantsOf(join.window());
      session_ = found.session;
      requests_.emplace(engine_, caller_, session_, person_id_, std::move(participant_key));
      news_.emplace(person_id_, join.marks_by_changes(), engine_.catalogue.Changes());
      SetAlarm(engine_.limits.time->Now() + kTokenPeriod);
    }
    if (join.window().hidden()) SetHidden(true);
    Wake();
    return absl::OkStatus();
  }

  absl::Status Obey(const v1::InteractRequest& request) {
    switch (request.message_case()) {
      case v1::InteractRequest::kAcknowledge:
        return Acknowledge(request.acknowledge());
      case v1::InteractRequest::kWindow:
        SetWindow(request.window());
        return absl::OkStatus();
      case v1::InteractRequest::kAlive:
        return absl::OkStatus();
      case v1::InteractRequest::kJoin:
        return base::InvalidField(
            "join", "was sent a second time; send it only as the first message", "ALREADY_JOINED");
      default:
        return requests_->Obey(shared_from_this(), request);
    }
  }

  absl::Status Acknowledge(const v1::Acknowledgement& acknowledgement) {
    std::shared_ptr<session::Session> watched;
    std::uint64_t watcher_id = 0;
    {
      const std::lock_guard lock(mutex_);
      watched = watched_;
      watcher_id = watcher_id_;
    }
    // An acknowledgement for a view that the viewer has left meanwhile is late, but not an error.
    if (watched == nullptr || acknowledgement.own_view() != (watched != session_)) {
      return absl::OkStatus();
    }
    if (acknowledgement.video_lost()) watched->hub().LoseVideo(watcher_id);
    watched->hub().Acknowledge(watcher_id, acknowledgement.sequence());
    return absl::OkStatus();
  }

  // Returns the delivery settings for a window. The caller must hold mutex_.
  delivery::ViewerWants WantsOf(const v1::Window& window) const {
    return {.window_width_px = static_cast<int>(window.width_px()),
            .frames_per_second = window.frames_per_second(),
            .adapts = true,
            .takes_video = takes_video_,
            .takes_resting_frames = takes_resting_frames_,
            .saves_bytes = window.saves_bytes()};
  }

  void SetWindow(const v1::Window& window) {
    {
      const std::lock_guard lock(mutex_);
      wants_ = WantsOf(window);
      if (watched_ != nullptr) watched_->hub().SetWants(watcher_id_, wants_);
    }
    SetHidden(window.hidden());
  }

  void SetHidden(bool hidden) {
    (void)session_->audience().Change(
        [&](session::Roster& roster) {
          roster.SetHidden(person_id_, hidden);
          return absl::OkStatus();
        },
        session_->Now());
    {
      const std::lock_guard lock(mutex_);
      hidden_ = hidden;
      Watch(Watched());
    }
    Wake();
  }

  Engine& engine_;
  const std::shared_ptr<const access::Caller> caller_;
  access::RequestBudget budget_;  // used only by the reading thread
  const Clock::time_point join_due_;
  std::shared_ptr<InteractCall> held_by_grpc_;
  std::optional<rpc_port::DeliveryDeadline> delivery_;
  grpc::ByteBuffer received_;
  grpc::ByteBuffer sent_;

  std::mutex mutex_;
  std::optional<grpc::Alarm> alarm_;  // for the join timeout, then for checks of the token
  bool reading_ = true;
  bool writing_ = false;
  bool finished_ = false;
  bool drain_told_ = false;
  bool end_told_ = false;
  std::optional<grpc::Status> end_;
  std::deque<grpc::ByteBuffer> answers_;
  std::size_t updates_ = 0;  // number of requests whose answer is pending (Await)

  // Join sets these members before anything else can use them.
  std::shared_ptr<session::Session> session_;
  std::uint64_t person_id_ = 0;
  std::optional<PersonRequests> requests_;
  std::optional<UntoldNews> news_;

  bool frame_next_ = false;
  bool hidden_ = false;
  bool takes_video_ = false;
  bool takes_resting_frames_ = false;
  delivery::ViewerWants wants_;
  std::shared_ptr<session::Session> watched_;  // the session whose frames are sent
  std::uint64_t watcher_id_ = 0;               // the viewer's id in the hub of watched_
  std::uint64_t told_doubts_ = 0;
  // Set while a CheckAlive message, which asks whether the person is still there, is being written.
  // The value is the number of the doubt that caused it (session::Person::doubts).
  std::optional<std::uint64_t> asking_for_;
};

}  // namespace

// gRPC releases the call in OnDone. The session and pending requests may keep it alive for longer.
InteractReactor* Interact(Engine& engine, grpc::CallbackServerContext* context,
                          std::shared_ptr<const access::Caller> caller,
                          double requests_per_second) {
  return InteractCall::Start(engine, context, std::move(caller), requests_per_second);
}

}  // namespace thunderhead::service
