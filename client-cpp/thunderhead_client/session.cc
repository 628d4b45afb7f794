#include "thunderhead_client/session.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "thunderhead_client/session_call.h"

namespace thunderhead::client {
namespace {

using Stub = v1::ThunderheadService::Stub;

// A call that lasted at least this long counts as healthy. If it is lost, the back-off begins again
// with a short delay.
constexpr std::chrono::seconds kSound{5};

bool IsLocked(grpc::StatusCode code) {
  return code == grpc::StatusCode::UNAUTHENTICATED || code == grpc::StatusCode::PERMISSION_DENIED;
}

bool RefusesScene(grpc::StatusCode code) {
  return code == grpc::StatusCode::NOT_FOUND || code == grpc::StatusCode::INVALID_ARGUMENT;
}

}  // namespace

Session::Session(std::shared_ptr<const Connection> connection, SessionOptions options,
                 SessionListener& listener)
    : connection_(std::move(connection)),
      options_(std::move(options)),
      listener_(listener),
      key_(options_.key),
      name_(options_.name),
      window_(options_.window),
      runner_([this] { Run(); }) {}

Session::~Session() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
    if (call_ != nullptr) call_->context.TryCancel();
  }
  calls_.Cancel();
  changed_.notify_all();
  runner_.join();
}

SessionState Session::State() const {
  const std::lock_guard lock(mutex_);
  return state_;
}

std::optional<SessionState> Session::StateAfter(std::uint64_t version) const {
  const std::lock_guard lock(mutex_);
  if (state_.version == version) return {};
  return state_;
}

void Session::Touch() {
  state_.scene = sync_.scene();
  state_.scene_revision = sync_.revision();
  ++state_.version;
}

void Session::Run() {
  while (true) {
    {
      const std::lock_guard lock(mutex_);
      if (ends_) return;
    }
    std::optional<Outcome> failure;
    if (key_.empty()) failure = Open();
    const Outcome outcome = failure ? *failure : Interact();
    {
      const std::lock_guard lock(mutex_);
      if (ends_) return;
    }
    Settle(outcome);
    const std::chrono::milliseconds delay = back_off_.Next(outcome.least);
    if (!Wait(outcome, delay)) return;
    connection_->AwaitReconnection([this] {
      const std::lock_guard lock(mutex_);
      return ends_;
    });
  }
}

// Forgets a session that no longer exists, so that the next attempt opens a new one with the same
// scene. Does nothing unless this client opened the session and the server has lost it, or
// never_gives_up is set.
void Session::Settle(const Outcome& outcome) {
  std::unique_lock lock(mutex_);
  if (outcome.link != Link::kGone) return;
  const bool reopens = (opens_sessions_ && outcome.forgotten) || options_.never_gives_up;
  if (!reopens) return;
  LeaveSession();
  state_.notice = outcome.forgotten
                      ? "The server had lost the session; this is a new one with the same scene."
                      : absl::StrCat("The last session has ended (", outcome.reason,
                                     "). This is a new one with the same scene.");
  ++state_.notice_count;
}

void Session::LeaveSession() {
  key_.clear();
  participant_key_.clear();
  state_.presenter_key.clear();
  state_.marks.Clear();
}

bool Session::Wait(const Outcome& outcome, std::chrono::milliseconds delay) {
  std::unique_lock lock(mutex_);
  const bool gone = outcome.link == Link::kGone && !key_.empty();
  state_.link = outcome.link == Link::kGone && !gone ? Link::kLost : outcome.link;
  state_.reason = outcome.reason;
  state_.retry_at = Clock::now() + delay;
  Touch();
  lock.unlock();
  listener_.Changed();
  lock.lock();
  const auto wakes = [this] { return ends_ || std::exchange(retry_now_, false); };
  if (gone) {
    changed_.wait(lock, wakes);
  } else {
    changed_.wait_for(lock, delay, wakes);
  }
  return !ends_;
}

std::optional<Session::Outcome> Session::Open() {
  v1::CreateSessionRequest request;
  {
    const std::lock_guard lock(mutex_);
    *request.mutable_scene() = state_.scene.ByteSizeLong() > 0 ? state_.scene : options_.scene;
    *request.mutable_rules() = options_.rules;
    if (window_.width_px() > 0) {
      request.mutable_scene()->mutable_output()->set_width_px(window_.width_px());
      request.mutable_scene()->mutable_output()->set_height_px(window_.height_px());
    }
  }
  v1::CreateSessionResponse response;
  grpc::Status status =
      connection_->Call(&Stub::CreateSession, request, &response, options_.patience, calls_);
  const std::string refusal = status.error_message();
  const bool began_anew = RefusesScene(status.error_code());
  if (began_anew) {
    // The scene's storm or time may no longer exist, so this requests the server's own first scene
    // at this window's size.
    v1::Scene plain;
    *plain.mutable_output() = request.scene().output();
    *request.mutable_scene() = std::move(plain);
    status = connection_->Call(&Stub::CreateSession, request, &response, options_.patience, calls_);
  }
  if (!status.ok()) {
    const Link link = IsLocked(status.error_code()) ? Link::kRefused : Link::kLost;
    return Outcome{link, connection_->Explain(status), RetryAfter(status)};
  }
  const std::lock_guard lock(mutex_);
  key_ = response.session_id();
  state_.presenter_key = key_;
  opened_ = opens_sessions_ = true;
  resumption_.End();
  if (response.has_durable() && !response.durable()) {
    Say("This session is not saved: it ends with the server, unless the server can save it later");
  }
  if (began_anew) Say(refusal + "; this is a new session without that scene");
  return {};
}

Session::Outcome Session::Interact() {
  Call call;
  if (const absl::Status status = connection_->Authorize(call.context); !status.ok()) {
    return {Link::kRefused, std::string(status.message())};
  }
  {
    const std::lock_guard lock(mutex_);
    outbox_.Clear();
    call.stream = connection_->stub().Interact(&call.context);
    call_ = &call;
    if (ends_) call.context.TryCancel();
  }
  std::thread writer([this, &call] { Write(call); });
  std::thread watcher([this, &call] { Watch(call); });
  v1::InteractResponse response;
  while (call.stream->Read(&response)) Take(call, response);
  {
    const std::lock_guard lock(mutex_);
    call.over = true;
    call_ = nullptr;
    state_.pointers.Clear();
    sync_.Rejoined();
  }
  changed_.notify_all();
  // A cancellation here would hide the status with which the server ended the call. A pending write
  // fails together with the call.
  writer.join();
  watcher.join();
  const grpc::Status status = call.stream->Finish();
  if (call.joined && Clock::now() - call.joined_at > kSound) back_off_.Reset();
  if (call.farewell) return *call.farewell;
  if (status.error_code() == grpc::StatusCode::NOT_FOUND) {
    return {Link::kGone, "The server no longer has this session", {}, true};
  }
  if (IsLocked(status.error_code())) return {Link::kRefused, status.error_message()};
  const std::string reason =
      status.ok() ? "The server ended the connection"
                  : (call.joined ? status.error_message() : connection_->Explain(status));
  return {Link::kLost, reason, RetryAfter(status)};
}

void Session::Write(Call& call) {
  std::unique_lock lock(mutex_);
  while (!call.over && !ends_) {
    std::optional<v1::InteractRequest> request = NextRequest(call, Clock::now());
    if (!request) {
      changed_.wait_until(lock, WakeAt(call));
      continue;
    }
    lock.unlock();
    const bool written = call.stream->Write(*request);
    lock.lock();
    if (!written) return;
  }
}

std::optional<v1::InteractRequest> Session::NextRequest(Call& call, Clock::time_point now) {
  std::optional<v1::InteractRequest> request;
  if (!call.joined) {
    if (call.last_request > 0) return {};
    request.emplace();
    v1::Join& join = *request->mutable_join();
    join.set_session_key(key_);
    join.set_name(name_);
    join.set_participant_key(participant_key_);
    join.set_marks_by_changes(true);
    join.set_answers_checks(true);
    *join.mutable_window() = window_;
    join.add_codecs(v1::CODEC_JPEG);
    for (const v1::Codec codec : options_.codecs) join.add_codecs(codec);
  } else if (!(request = outbox_.Next(now)) && state_.Steers()) {
    if (auto outgoing = sync_.Next(now)) {
      request.emplace();
      *request->mutable_update_scene()->mutable_scene() = std::move(outgoing->scene);
      request->mutable_update_scene()->set_expected_revision(outgoing->expected_revision);
      call.scenes[call.last_request + 1] = {outgoing->ticket, now};
    }
  }
  if (!request) return {};
  request->set_request_id(++call.last_request);
  call.requests[call.last_request] = request->message_case();
  if (call.requests.size() > Call::kMaxRemembered) call.requests.erase(call.requests.begin());
  return request;
}

Session::Clock::time_point Session::WakeAt(const Call& call) const {
  Clock::time_point wake = Clock::now() + options_.patience;
  if (!call.joined) return wake;
  if (const auto due = outbox_.WakeAt()) wake = std::min(wake, *due);
  if (const auto due = sync_.WakeAt()) wake = std::min(wake, *due);
  return wake;
}

// Detects a connection that was cut without notice to either side. If the server was silent for a
// while, another call must reach it.
void Session::Watch(Call& call) {
  constexpr std::chrono::seconds kSilence{10};
  constexpr std::chrono::seconds kCheck{5};
  constexpr int kFailedChecks = 2;
  int failures = 0;
  std::unique_lock lock(mutex_);
  while (!call.over && !ends_) {
    const auto now = Clock::now();
    const bool late = !call.joined && now - call.began > options_.patience;
    if (late || failures >= kFailedChecks) {
      call.farewell = Outcome{Link::kLost, "The server cannot be reached"};
      call.context.TryCancel();
      return;
    }
    if (now - call.heard_at < kSilence) {
      failures = 0;
      changed_.wait_until(lock, call.heard_at + kSilence);
      continue;
    }
    lock.unlock();
    v1::GetServerInfoResponse response;
    const grpc::Status status = connection_->Call(&Stub::GetServerInfo, v1::GetServerInfoRequest(),
                                                  &response, kCheck, calls_);
    lock.lock();
    const bool reached = status.error_code() != grpc::StatusCode::UNAVAILABLE &&
                         status.error_code() != grpc::StatusCode::DEADLINE_EXCEEDED;
    failures = reached ? 0 : failures + 1;
    if (reached) call.heard_at = Clock::now();
  }
}

}  // namespace thunderhead::client
