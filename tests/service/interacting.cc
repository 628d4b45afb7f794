#include "tests/service/interacting.h"

#include <algorithm>
#include <utility>

#include "google/rpc/error_details.pb.h"

namespace thunderhead::testing {
namespace {

void Apply(const v1::Marks& told, v1::Marks* all) {
  if (!told.only_changes()) {
    *all = told;
    return;
  }
  for (const std::uint64_t id : told.erased_mark_ids()) {
    const auto at = std::ranges::find(all->marks(), id, &v1::Mark::mark_id);
    if (at != all->marks().end()) all->mutable_marks()->erase(at);
  }
  for (const v1::Mark& mark : told.marks()) {
    const auto at = std::ranges::find(*all->mutable_marks(), mark.mark_id(), &v1::Mark::mark_id);
    if (at != all->mutable_marks()->end()) {
      *at = mark;
    } else {
      *all->add_marks() = mark;
    }
  }
}

}  // namespace

std::string ReasonOf(const google::rpc::Status& refusal) {
  google::rpc::ErrorInfo info;
  for (const auto& detail : refusal.details()) {
    if (detail.UnpackTo(&info)) return info.reason();
  }
  return "";
}

std::string ReasonOf(const grpc::Status& refusal) {
  google::rpc::Status status;
  return status.ParseFromString(refusal.error_details()) ? ReasonOf(status) : "";
}

std::chrono::milliseconds RetryAfterOf(const google::rpc::Status& refusal) {
  google::rpc::RetryInfo retry;
  for (const auto& detail : refusal.details()) {
    if (!detail.UnpackTo(&retry)) continue;
    return std::chrono::milliseconds(1000 * retry.retry_delay().seconds() +
                                     retry.retry_delay().nanos() / 1'000'000);
  }
  return {};
}

Interacting::Interacting(v1::ThunderheadService::Stub& stub, const std::string& key,
                         Options options)
    : options_(std::move(options)), call_(stub.Interact(&context_)) {
  v1::InteractRequest request;
  request.mutable_join()->set_session_key(key);
  request.mutable_join()->set_name(options_.name);
  request.mutable_join()->mutable_window()->set_hidden(options_.hidden);
  request.mutable_join()->mutable_window()->set_saves_bytes(options_.saves_bytes);
  request.mutable_join()->set_participant_key(options_.participant_key);
  request.mutable_join()->set_marks_by_changes(!options_.is_old);
  request.mutable_join()->set_answers_checks(!options_.is_old);
  for (const v1::Codec codec : options_.codecs) request.mutable_join()->add_codecs(codec);
  Send(request);
  thread_ = std::thread([this] { Run(); });
}

Interacting::~Interacting() {
  Cancel();
  if (thread_.joinable()) thread_.join();
}

std::uint64_t Interacting::Send(v1::InteractRequest request) {
  const std::lock_guard lock(write_mutex_);
  request.set_request_id(++request_count_);
  call_->Write(request);
  return request_count_;
}

void Interacting::Run() {
  for (v1::InteractResponse response; call_->Read(&response);) {
    const bool checked = response.has_check_alive() && options_.answers_checks;
    const bool acknowledge = response.has_frame() && options_.acknowledges;
    if (response.has_joined()) viewer_id_ = response.joined().viewer_id();
    v1::InteractRequest acknowledged;
    acknowledged.mutable_acknowledge()->set_sequence(response.frame().sequence());
    acknowledged.mutable_acknowledge()->set_own_view(response.frame().own_view());
    {
      const std::lock_guard lock(mutex_);
      if (response.has_marks()) {
        marks_as_told_.push_back(response.marks());
        Apply(response.marks(), &marks_);
        *response.mutable_marks() = marks_;
      }
      messages_.push_back(std::move(response));
    }
    changed_.notify_all();
    if (acknowledge) Send(acknowledged);
    if (checked) {
      v1::InteractRequest alive;
      alive.mutable_alive();
      Send(alive);
    }
  }
  const grpc::Status end = call_->Finish();
  const std::lock_guard lock(mutex_);
  end_ = end;
}

bool Interacting::Await(const std::function<bool(const Messages&)>& wanted,
                        std::chrono::seconds patience) {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, patience, [&] { return wanted(messages_); });
}

v1::InteractResponse Interacting::AwaitNewest(v1::InteractResponse::MessageCase part) {
  v1::InteractResponse newest;
  Await([&](const Messages& messages) {
    const auto at = std::find_if(messages.rbegin(), messages.rend(), [&](const auto& message) {
      return message.message_case() == part;
    });
    if (at == messages.rend()) return false;
    newest = *at;
    return true;
  });
  return newest;
}

v1::InteractResponse Interacting::Answer(std::uint64_t request_id) {
  v1::InteractResponse answer;
  Await([&](const Messages& messages) {
    const auto at = std::ranges::find_if(messages, [&](const auto& message) {
      return message.refused().request_id() == request_id ||
             message.scene_taken().request_id() == request_id;
    });
    if (at == messages.end()) return false;
    answer = *at;
    return true;
  });
  return answer;
}

grpc::StatusCode Interacting::AnswerCode(std::uint64_t request_id) {
  const v1::InteractResponse answer = Answer(request_id);
  if (answer.message_case() == v1::InteractResponse::MESSAGE_NOT_SET) {
    return grpc::StatusCode::DEADLINE_EXCEEDED;
  }
  return static_cast<grpc::StatusCode>(answer.refused().status().code());
}

bool Interacting::AwaitPresence(const std::function<bool(const v1::Presence&)>& wanted) {
  return Await([&](const Messages& messages) {
    const auto at = std::find_if(messages.rbegin(), messages.rend(),
                                 [](const auto& message) { return message.has_presence(); });
    return at != messages.rend() && wanted(at->presence());
  });
}

bool Interacting::AwaitMarks(const std::function<bool(const v1::Marks&)>& wanted) {
  return Await([&](const Messages& messages) {
    const auto at = std::find_if(messages.rbegin(), messages.rend(),
                                 [](const auto& message) { return message.has_marks(); });
    return at != messages.rend() && wanted(at->marks());
  });
}

std::vector<v1::Marks> Interacting::MarksAsTold() {
  const std::lock_guard lock(mutex_);
  return marks_as_told_;
}

v1::Scene Interacting::AwaitScene(std::uint64_t revision) {
  v1::Scene scene;
  Await([&](const Messages& messages) {
    const auto at = std::find_if(messages.rbegin(), messages.rend(), [&](const auto& message) {
      return message.scene().scene_revision() >= revision;
    });
    if (at == messages.rend()) return false;
    scene = at->scene().scene();
    return true;
  });
  return scene;
}

bool Interacting::AwaitFrame(std::uint64_t revision, bool own_view) {
  return Await([&](const Messages& messages) {
    return std::ranges::any_of(messages, [&](const auto& message) {
      return message.has_frame() && message.frame().own_view() == own_view &&
             message.frame().scene_revision() >= revision;
    });
  });
}

Interacting::Messages Interacting::All() {
  const std::lock_guard lock(mutex_);
  return messages_;
}

std::uint64_t Interacting::viewer_id() {
  // Does not take the lock once the id is known, so that conditions that wait for other viewers'
  // messages may call it.
  if (viewer_id_ == 0) AwaitNewest(v1::InteractResponse::kJoined);
  return viewer_id_;
}

std::string Interacting::participant_key() {
  return AwaitNewest(v1::InteractResponse::kJoined).joined().participant_key();
}

void Interacting::Leave() {
  const std::lock_guard lock(write_mutex_);
  call_->WritesDone();
}

grpc::Status Interacting::End() {
  if (thread_.joinable()) thread_.join();
  return end_;
}

}  // namespace thunderhead::testing
