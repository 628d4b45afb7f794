#include "service/interact.h"

#include <grpcpp/alarm.h>
#include <grpcpp/support/proto_buffer_reader.h>

#include <atomic>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <variant>

#include "absl/strings/str_cat.h"
#include "access/rules.h"
#include "base/error_details.h"
#include "base/out_of_memory.h"
#include "base/status.h"
#include "service/catalogue_follower.h"
#include "service/delivery_deadline.h"
#include "service/frame_messages.h"
#include "service/interact_messages.h"
#include "service/looking_around.h"
#include "service/messages/camera_messages.h"
#include "service/messages/limits_check.h"
#include "service/messages/prepare_scene.h"
#include "service/messages/scene_messages.h"
#include "service/scene_update.h"
#include "service/status_table.h"
#include "service/untold_news.h"
#include "session/upkeep.h"

namespace thunderhead::service {
namespace {

using session::Clock;

// Answers that wait for a slow client; no further request is read until it has taken some.
constexpr std::size_t kMaxWaitingAnswers = 16;

absl::Status NotJoined() {
  return base::InvalidField("join", "is missing; it must be the first message, and only the first",
                            "NOT_JOINED");
}

absl::Status JoinedTooLate(std::chrono::milliseconds limit) {
  return base::WithDetails(
      absl::DeadlineExceededError(
          absl::StrCat("no join came within ", limit.count(), " ms; it must be the first message")),
      {.reason = "NOT_JOINED"});
}

absl::Status Replaced() {
  return base::WithDetails(
      absl::AbortedError("somebody has joined with this connection's participant_key, and it did "
                         "not answer when asked; join again"),
      {.reason = "CONNECTION_REPLACED"});
}

// The name of a request that is written to the audit whatever its outcome; null for others.
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

// "Interact/update_scene"
std::string NameOfRequest(const v1::InteractRequest& request) {
  const auto* const field =
      v1::InteractRequest::descriptor()->FindFieldByNumber(request.message_case());
  return absl::StrCat("Interact/", field == nullptr ? "unknown" : field->name());
}

// One client's call. It lives until gRPC, the session and the updates on their way have released
// it. There is at most one pending read and one pending write; Finish is called once, when nothing
// is being written. Requests are handled one after another, by the thread of the read; what is to
// be written is chosen when the last write is done, so that the newest wins.
class InteractCall : public InteractReactor,
                     public session::Viewer,
                     public std::enable_shared_from_this<InteractCall> {
 public:
  static InteractReactor* Start(Engine& engine, grpc::CallbackServerContext* context,
                                std::shared_ptr<const access::Caller> caller,
                                double requests_per_second) {
    auto call =
        std::make_shared<InteractCall>(engine, context, std::move(caller), requests_per_second);
    call->held_by_grpc_ = call;
    call->join_alarm_.Set(std::chrono::system_clock::now() + engine.limits.join_timeout,
                          [weak = std::weak_ptr(call)](bool rang) {
                            const auto self = weak.lock();
                            if (rang && self != nullptr) self->JoinTooLate();
                          });
    call->StartRead(&call->received_);
    return call.get();
  }

  InteractCall(Engine& engine, grpc::CallbackServerContext* context,
               std::shared_ptr<const access::Caller> caller, double requests_per_second)
      : engine_(engine),
        caller_(std::move(caller)),
        budget_(requests_per_second, Clock::now()),
        delivery_(std::in_place, context, engine.limits) {}

  // Writes the next message, or ends the call, if there is a reason to and nothing is being
  // written.
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
    if (const absl::Status status = Handle(); !status.ok()) return End(ToGrpcStatus(status));
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
      session_->audience().Checked(person_id_, *doubts, Clock::now());
    }
    ReadOn();
    Wake();
  }

  void OnCancel() override {
    End(grpc::Status(grpc::StatusCode::CANCELLED, "the client cancelled the call"));
  }

  void OnDone() override {
    if (session_ != nullptr) {
      // First, as a session that nobody watches expires sooner.
      session_->Touch();
      {
        const std::lock_guard lock(mutex_);
        Watch(nullptr);
      }
      session_->audience().Leave(person_id_, Clock::now());
    }
    delivery_.reset();  // the session and updates may keep the call for longer
    held_by_grpc_.reset();
  }

 private:
  void JoinTooLate() {
    {
      const std::lock_guard lock(mutex_);
      if (session_ != nullptr) return;
    }
    const absl::Status status = JoinedTooLate(engine_.limits.join_timeout);
    caller_->Report("Interact/join", status);
    End(ToGrpcStatus(status));
  }

  // Ends the call as soon as nothing is being written. The first reason counts.
  void End(const grpc::Status& status) {
    {
      const std::lock_guard lock(mutex_);
      if (!end_.has_value()) end_ = status;
    }
    Wake();
  }

  // The status to end the call with, if it must end now. Needs mutex_.
  std::optional<grpc::Status> Ended() {
    if (end_.has_value()) return end_;
    if (session_ == nullptr) return std::nullopt;
    if (!session_->audience().IsThere(person_id_)) return ToGrpcStatus(Replaced());
    if (!end_told_) return std::nullopt;
    return ToGrpcStatus(session_->hub().ClosedBecause());
  }

  // The next message, if there is one. Needs mutex_.
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
    // In turn, so that neither holds up the other on a slow link.
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
    if (const auto* frame = std::get_if<std::shared_ptr<const session::EncodedFrame>>(&*event)) {
      return FrameResponse(*frame, watched_ != session_);
    }
    v1::InteractResponse response;
    ToMessage(std::get<session::Problem>(*event), *response.mutable_problem());
    response.mutable_problem()->set_own_view(watched_ != session_);
    return ResponseOf(response);
  }

  // The person's picture: the session's, the own view, or nothing. Needs mutex_.
  std::shared_ptr<session::Session> Watched() {
    const std::shared_ptr<session::Session> own_view =
        around_.Drawn([this] { return session_->audience().Follows(person_id_); });
    if (hidden_) return nullptr;
    return own_view == nullptr ? session_ : own_view;
  }

  // Receives the frames of `session` from now on. Needs mutex_.
  void Watch(const std::shared_ptr<session::Session>& session) {
    if (session == watched_) return;
    if (watched_ != nullptr) watched_->hub().Leave(watcher_id_);
    watched_ = nullptr;
    if (session == nullptr) return;
    const auto watcher_id = session->hub().Join(shared_from_this(), wants_);
    if (!watcher_id.ok()) return;  // it has closed, which the next message tells
    watched_ = session;
    watcher_id_ = *watcher_id;
  }

  // Reads the next request unless too many answers wait.
  void ReadOn() {
    // Begun under the lock: without a pending read or write, nothing else keeps the call from being
    // finished meanwhile.
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

  // An error ends the call; a request that is merely refused has an answer.
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
    absl::Status status = budget_.Take(Clock::now());
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
    // Who is a viewer by their token stays one, whichever key was passed on to them.
    const session::Role role =
        access::MayPresent(caller_->identity().role) ? found.role : session::Role::kViewer;
    const std::size_t most = engine_.limits.max_viewers_per_session;
    const std::optional<std::uint64_t> person_id = found.session->audience().Join(
        role, name, shared_from_this(), Clock::now(), most, participant_key, join.answers_checks());
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
      participant_key_ = std::move(participant_key);
      answers_.push_back(ResponseOf(response));
      hidden_ = join.window().hidden();
      for (const int codec : join.codecs()) {
        takes_video_ = takes_video_ || codec == v1::CODEC_VP9;
        takes_stills_ = takes_stills_ || codec == v1::CODEC_AVIF;
      }
      wants_ = WantsOf(join.window());
      session_ = found.session;
      news_.emplace(person_id_, join.marks_by_changes(), engine_.catalogue.Changes());
    }
    join_alarm_.Cancel();
    if (join.window().hidden()) SetHidden(true);
    Wake();
    return absl::OkStatus();
  }

  absl::Status Obey(const v1::InteractRequest& request) {
    switch (request.message_case()) {
      case v1::InteractRequest::kUpdateScene:
        return Update(request.request_id(), request.update_scene());
      case v1::InteractRequest::kAcknowledge:
        return Acknowledge(request.acknowledge());
      case v1::InteractRequest::kMoveCamera:
        return MoveCamera(request.request_id(), request.move_camera());
      case v1::InteractRequest::kDetach:
        return Detach(request.request_id(), request.detach());
      case v1::InteractRequest::kWindow:
        SetWindow(request.window());
        return absl::OkStatus();
      case v1::InteractRequest::kPoint:
        return Point(request.point());
      case v1::InteractRequest::kAddMark:
        return AddMark(request.request_id(), request.add_mark());
      case v1::InteractRequest::kEraseMarks:
        return EraseMarks(request.erase_marks());
      case v1::InteractRequest::kSetName:
        return SetName(request.set_name().name());
      case v1::InteractRequest::kFollow:
      case v1::InteractRequest::kAskControl:
      case v1::InteractRequest::kGiveControl:
      case v1::InteractRequest::kRefuseControl:
      case v1::InteractRequest::kTakeControl:
      case v1::InteractRequest::kSetRules:
        return ChangeRoster(request);
      case v1::InteractRequest::kAlive:
        return absl::OkStatus();
      case v1::InteractRequest::kJoin:
        return base::InvalidField("join", "comes a second time; it must be the first message only",
                                  "ALREADY_JOINED");
      case v1::InteractRequest::MESSAGE_NOT_SET:
        break;
    }
    return base::InvalidField("message", "is missing, or newer than this server",
                              "MESSAGE_UNKNOWN");
  }

  absl::Status ChangeRoster(const v1::InteractRequest& request) {
    const Clock::time_point now = Clock::now();
    absl::Status status = session_->audience().Change(
        [&](session::Roster& roster) {
          switch (request.message_case()) {
            case v1::InteractRequest::kFollow:
              return roster.Follow(person_id_);
            case v1::InteractRequest::kAskControl:
              return roster.AskControl(person_id_, now);
            case v1::InteractRequest::kGiveControl:
              return roster.GiveControl(person_id_, request.give_control().viewer_id(), now);
            case v1::InteractRequest::kRefuseControl:
              return roster.RefuseControl(person_id_, request.refuse_control().viewer_id());
            case v1::InteractRequest::kTakeControl:
              return roster.TakeControl(person_id_);
            default:
              return roster.SetRules(person_id_,
                                     RulesOf(request.set_rules().rules(), roster.rules()));
          }
        },
        now);
    Wake();  // who follows again is told of the change later, but sees the session at once
    return status;
  }

  absl::Status SetName(const std::string& text) {
    THUNDERHEAD_ASSIGN_OR_RETURN(const std::string name, NameOf(text, "set_name.name"));
    return session_->audience().Change(
        [&](session::Roster& roster) {
          roster.Rename(person_id_, name);
          return absl::OkStatus();
        },
        Clock::now());
  }

  absl::Status Update(std::uint64_t request_id, const v1::SceneUpdate& update) {
    AddUpdate();
    ChangeScene(
        engine_, caller_->identity().name, session_, SceneChangeOf(update),
        [self = shared_from_this()] {
          return self->session_->audience().MaySteer(self->person_id_);
        },
        [self = shared_from_this(), request_id](const auto& revision) {
          self->caller_->ReportRefusal("Interact/update_scene", revision.status());
          self->Updated(request_id, revision);
        });
    return absl::OkStatus();
  }

  void Updated(std::uint64_t request_id, const absl::StatusOr<std::uint64_t>& revision) {
    EndUpdate();
    v1::InteractResponse response;
    if (revision.ok()) {
      response.mutable_scene_taken()->set_request_id(request_id);
      response.mutable_scene_taken()->set_scene_revision(*revision);
    } else {
      response = RefusedResponse(request_id, revision.status());
    }
    Answer(response);
  }

  absl::Status Acknowledge(const v1::Acknowledgement& acknowledgement) {
    std::shared_ptr<session::Session> watched;
    std::uint64_t watcher_id = 0;
    {
      const std::lock_guard lock(mutex_);
      watched = watched_;
      watcher_id = watcher_id_;
    }
    // One for a view that was left meanwhile is late, not wrong.
    if (watched == nullptr || acknowledgement.own_view() != (watched != session_)) {
      return absl::OkStatus();
    }
    if (acknowledgement.video_lost()) watched->hub().LoseVideo(watcher_id);
    watched->hub().Acknowledge(watcher_id, acknowledgement.sequence());
    return absl::OkStatus();
  }

  // Calls `then` with the camera whose defaults are filled in, or with why there is none: at once,
  // or on the executor if they depend on the storm. Not if it returns an error.
  absl::Status WithCamera(std::uint64_t request_id, const v1::Camera& message,
                          std::function<absl::Status(const absl::StatusOr<scene::Camera>&)> then) {
    THUNDERHEAD_ASSIGN_OR_RETURN(const ReadScene newest, NewestSceneOf(*session_));
    const auto scene = std::make_shared<v1::Scene>(newest.scene);
    if (message.kind_case() != v1::Camera::KIND_NOT_SET) *scene->mutable_camera() = message;
    THUNDERHEAD_RETURN_IF_ERROR(PrepareScene(engine_.store, engine_.loop.Techniques(), *scene));
    AddUpdate();
    FrameThen(engine_, caller_->identity().name, *scene,
              [self = shared_from_this(), request_id, scene,
               then = std::move(then)](const absl::Status& framed) {
                using Camera = absl::StatusOr<scene::Camera>;
                self->UpdateDone(
                    request_id, base::OrOutOfMemory([&] {
                      return then(framed.ok() ? Camera(ToCamera(scene->camera())) : Camera(framed));
                    }));
              });
    return absl::OkStatus();
  }

  // Cameras of the own view take effect in the order of their requests, though some wait for the
  // storm's fields. Who returns to the session's view meanwhile stays there.
  absl::Status Detach(std::uint64_t request_id, const v1::Detach& detach) {
    const std::uint64_t returns = session_->audience().Returns(person_id_);
    const std::uint64_t look = around_.Begin(true);
    // Not before there is a view of one's own: who is refused a camera goes on following.
    absl::Status asked = WithCamera(
        request_id, detach.camera(),
        [this, look, returns](const absl::StatusOr<scene::Camera>& camera) -> absl::Status {
          bool detached = false;
          absl::Status status = camera.status();
          if (status.ok()) {
            status = session_->audience().Change(
                [&](session::Roster& roster) -> absl::Status {
                  THUNDERHEAD_ASSIGN_OR_RETURN(detached, roster.Detach(person_id_, returns));
                  return absl::OkStatus();
                },
                Clock::now());
          }
          if (detached) {
            around_.LookFrom(look, *camera, [this](const scene::Camera& first) {
              return engine_.sessions.OpenView(session_, first, caller_->identity().name);
            });
            Wake();
          }
          around_.EndDetach();
          return status;
        });
    if (!asked.ok()) around_.EndDetach();
    return asked;
  }

  absl::Status MoveCamera(std::uint64_t request_id, const v1::MoveCamera& move) {
    if (!around_.Looks()) {
      return base::WithDetails(
          absl::FailedPreconditionError("you follow the session's view; detach from it first"),
          {.reason = "NOT_DETACHED"});
    }
    const std::uint64_t look = around_.Begin(false);
    return WithCamera(request_id, move.camera(),
                      [this, look](const absl::StatusOr<scene::Camera>& camera) {
                        if (camera.ok()) around_.LookFrom(look, *camera, nullptr);
                        return camera.status();
                      });
  }

  // A request is on its way to its answer.
  void AddUpdate() {
    const std::lock_guard lock(mutex_);
    ++updates_;
  }

  void EndUpdate() {
    const std::lock_guard lock(mutex_);
    --updates_;
  }

  void UpdateDone(std::uint64_t request_id, const absl::Status& status) {
    EndUpdate();
    if (!status.ok()) return Answer(RefusedResponse(request_id, status));
    ReadOn();
  }

  // Needs mutex_.
  session::ViewerWants WantsOf(const v1::Window& window) const {
    return {.window_width_px = static_cast<int>(window.width_px()),
            .frames_per_second = window.frames_per_second(),
            .adapts = true,
            .takes_video = takes_video_,
            .takes_stills = takes_stills_,
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
        Clock::now());
    {
      const std::lock_guard lock(mutex_);
      hidden_ = hidden;
      Watch(Watched());
    }
    Wake();
  }

  absl::Status Point(const v1::Point& point) {
    std::optional<session::Ray> ray;
    if (point.has_ray()) {
      THUNDERHEAD_ASSIGN_OR_RETURN(ray, RayOf(point.ray(), "point.ray"));
    }
    return session_->audience().Point(person_id_, ray, Clock::now());
  }

  // Finds the places on the executor: they are many.
  absl::Status AddMark(std::uint64_t request_id, const v1::AddMark& message) {
    THUNDERHEAD_RETURN_IF_ERROR(session_->audience().MayMark(person_id_));
    if (drawing_.exchange(true)) {
      return base::WithDetails(
          absl::ResourceExhaustedError("your last mark is still being placed; wait for it"),
          {.reason = "MARKS_TOO_FAST", .retry_after = std::chrono::milliseconds(200)});
    }
    absl::Status status = PlaceMark(request_id, message);
    if (!status.ok()) drawing_ = false;
    return status;
  }

  absl::Status PlaceMark(std::uint64_t request_id, const v1::AddMark& message) {
    std::vector<session::Ray> rays;
    for (const v1::Ray& one : message.rays()) {
      const std::string path = absl::StrCat("add_mark.rays[", rays.size(), "]");
      THUNDERHEAD_ASSIGN_OR_RETURN(rays.emplace_back(), RayOf(one, path));
    }
    if (rays.empty()) {
      return base::InvalidField("add_mark.rays", "is empty; a mark has at least one corner",
                                "VALUE_MISSING");
    }
    std::optional<glm::vec3> color;
    if (message.has_color()) {
      color = glm::vec3(message.color().red(), message.color().green(), message.color().blue());
    }
    AddUpdate();
    engine_.executor.Submit(
        caller_->identity().name, [self = shared_from_this(), request_id, rays = std::move(rays),
                                   color](const absl::Status& status) {
          const absl::Status drawn =
              status.ok() ? base::OrOutOfMemory([&] { return self->Draw(rays, color); }) : status;
          self->drawing_ = false;
          self->UpdateDone(request_id, drawn);
        });
    return absl::OkStatus();
  }

  absl::Status Draw(const std::vector<session::Ray>& rays, const std::optional<glm::vec3>& color) {
    std::vector<glm::dvec3> positions_m = session::LineSeen(*session_, engine_.store, rays);
    return session_->audience().Draw(
        person_id_,
        [&](session::Board& board) {
          return board.Add(person_id_, std::move(positions_m), color, participant_key_).status();
        },
        Clock::now());
  }

  absl::Status EraseMarks(const v1::EraseMarks& message) {
    return session_->audience().Erase(
        person_id_, {message.mark_ids().begin(), message.mark_ids().end()}, Clock::now());
  }

  Engine& engine_;
  const std::shared_ptr<const access::Caller> caller_;
  access::RequestBudget budget_;  // used by the reading thread alone
  grpc::Alarm join_alarm_;
  std::shared_ptr<InteractCall> held_by_grpc_;
  std::optional<DeliveryDeadline> delivery_;
  grpc::ByteBuffer received_;
  grpc::ByteBuffer sent_;

  std::mutex mutex_;
  bool reading_ = true;
  bool writing_ = false;
  bool finished_ = false;
  bool drain_told_ = false;
  bool end_told_ = false;
  std::optional<grpc::Status> end_;
  std::deque<grpc::ByteBuffer> answers_;
  std::size_t updates_ = 0;  // on their way to an answer

  // Set by Join before anything else can use them.
  std::shared_ptr<session::Session> session_;
  std::uint64_t person_id_ = 0;
  std::string participant_key_;

  std::atomic<bool> drawing_{false};  // a mark is on its way
  bool frame_next_ = false;
  bool hidden_ = false;
  bool takes_video_ = false;
  bool takes_stills_ = false;
  session::ViewerWants wants_;
  LookingAround around_;                       // safe without mutex_
  std::shared_ptr<session::Session> watched_;  // whose frames come
  std::uint64_t watcher_id_ = 0;               // in its hub
  std::uint64_t told_doubts_ = 0;
  std::optional<std::uint64_t> asking_for_;  // the doubt that the message being written is about
  std::optional<UntoldNews> news_;           // of who has joined
};

}  // namespace

// Deletes itself when gRPC calls OnDone.
InteractReactor* Interact(Engine& engine, grpc::CallbackServerContext* context,
                          std::shared_ptr<const access::Caller> caller,
                          double requests_per_second) {
  return InteractCall::Start(engine, context, std::move(caller), requests_per_second);
}

}  // namespace thunderhead::service
