#include "load/presenter.h"

#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "load/response_reader.h"
#include "load/turning.h"
#include "thunderhead/v1/interact.pb.h"

namespace thunderhead::load {

Presenter::Presenter(v1::Camera camera, Errors& errors)
    : errors_(errors), camera_(std::move(camera)) {}

void Presenter::Join(Transport& transport, const std::string& key) {
  v1::InteractRequest request;
  request.mutable_join()->set_session_key(key);
  request.mutable_join()->set_marks_by_changes(true);
  request.mutable_join()->mutable_window()->set_hidden(true);
  link_ = transport.Interact(*this, {});
  link_->Send(request.SerializeAsString());
}

void Presenter::Turn(double angle_deg) {
  load::Turn(angle_deg, camera_);
  v1::InteractRequest request;
  request.set_request_id(++request_count_);
  *request.mutable_update_scene()->mutable_scene()->mutable_camera() = camera_;
  request.mutable_update_scene()->mutable_update_mask()->add_paths("camera");
  {
    const std::lock_guard lock(mutex_);
    unanswered_s_[request_count_] = Now_s();
  }
  link_->Send(request.SerializeAsString());
}

void Presenter::Leave() {
  leaving_ = true;
  link_->HalfClose();
}

std::vector<Update> Presenter::Updates() const {
  std::vector<Update> updates;
  updates.reserve(sent_s_.size());
  for (const auto& [revision, sent_s] : sent_s_) updates.push_back({sent_s, revision});
  return updates;
}

void Presenter::OnMessage(google::protobuf::io::ZeroCopyInputStream& message,
                          std::size_t /*bytes*/) {
  const std::optional<Response> response = ReadResponse(message);
  if (!response.has_value()) return errors_.Add(kUnreadable);
  if (response->part == Response::Part::kRefused) {
    return errors_.Add(absl::StrCat("the presenter was refused: ", response->refusal));
  }
  if (response->part != Response::Part::kSceneTaken) return;
  const std::lock_guard lock(mutex_);
  const auto request = unanswered_s_.find(response->request_id);
  if (request == unanswered_s_.end()) return;
  sent_s_[response->scene_revision] = request->second;
  unanswered_s_.erase(request);
}

void Presenter::OnEnd(const absl::Status& status) {
  if (!status.ok()) {
    errors_.Add(status.ToString());
  } else if (!leaving_) {
    errors_.Add("the server ended a call early, without an error");
  }
  ended_ = true;
}

}  // namespace thunderhead::load
