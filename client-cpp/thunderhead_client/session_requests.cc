// The actions of a person in a session. Each method puts a message into the outbox.
#include <utility>

#include "thunderhead_client/session.h"

namespace thunderhead::client {

void Session::Send(v1::InteractRequest request) {
  if (state_.link == Link::kLive) outbox_.Send(std::move(request));
  changed_.notify_all();
}

bool Session::Edit(SceneSync::Edit edit) {
  const std::lock_guard lock(mutex_);
  if (!state_.Steers()) return false;
  sync_.Edited(std::move(edit));
  state_.problem.reset();
  Touch();
  changed_.notify_all();
  return true;
}

bool Session::ShowCamera(const v1::Camera& camera) {
  const std::lock_guard lock(mutex_);
  if (state_.Steers()) {
    sync_.Edited([camera](v1::Scene& scene) { *scene.mutable_camera() = camera; });
  } else if (!state_.MayLookAround()) {
    return false;
  } else if (state_.looks_around) {
    state_.own_camera = camera;
    outbox_.MoveCamera(camera);
  } else {
    state_.looks_around = true;
    state_.own_camera = camera;
    v1::InteractRequest request;
    *request.mutable_detach()->mutable_camera() = camera;
    Send(std::move(request));
  }
  Touch();
  changed_.notify_all();
  return true;
}

void Session::Follow() {
  const std::lock_guard lock(mutex_);
  if (!state_.looks_around) return;
  state_.looks_around = false;
  outbox_.DropCamera();
  v1::InteractRequest request;
  request.mutable_follow();
  Send(std::move(request));
  Touch();
}

void Session::Shown(const v1::Frame& frame) {
  const std::lock_guard lock(mutex_);
  v1::Acknowledgement acknowledgement;
  acknowledgement.set_sequence(frame.sequence());
  acknowledgement.set_own_view(frame.own_view());
  outbox_.Acknowledge(acknowledgement);
  if (frame.own_view() == state_.looks_around) {
    state_.shown_camera = frame.camera();
    state_.shown_sun = frame.sun();
  }
  const bool solved = state_.problem && state_.problem->own_view() == frame.own_view() &&
                      frame.scene_revision() >= state_.problem->scene_revision();
  if (solved) state_.problem.reset();
  ++state_.version;
  changed_.notify_all();
}

void Session::VideoLost(const v1::Frame& frame) {
  const std::lock_guard lock(mutex_);
  v1::Acknowledgement acknowledgement;
  acknowledgement.set_sequence(frame.sequence());
  acknowledgement.set_own_view(frame.own_view());
  acknowledgement.set_video_lost(true);
  outbox_.Acknowledge(acknowledgement);
  changed_.notify_all();
}

void Session::SetWindow(const v1::Window& window) {
  const std::lock_guard lock(mutex_);
  window_ = window;
  // The window is sent even while a join is pending, because the join may carry the previous
  // window.
  outbox_.Resize(window);
  changed_.notify_all();
}

void Session::SetName(const std::string& name) {
  const std::lock_guard lock(mutex_);
  name_ = name;
  v1::InteractRequest request;
  request.mutable_set_name()->set_name(name);
  Send(std::move(request));
}

void Session::Point(const std::optional<v1::Ray>& ray) {
  const std::lock_guard lock(mutex_);
  if (!state_.MayMark()) return;
  v1::Point point;
  if (ray) *point.mutable_ray() = *ray;
  outbox_.PointTo(point);
  changed_.notify_all();
}

void Session::AddMark(const std::vector<v1::Ray>& rays) {
  const std::lock_guard lock(mutex_);
  v1::InteractRequest request;
  for (const v1::Ray& ray : rays) *request.mutable_add_mark()->add_rays() = ray;
  Send(std::move(request));
}

void Session::EraseMarks() {
  const std::lock_guard lock(mutex_);
  v1::InteractRequest request;
  request.mutable_erase_marks();
  Send(std::move(request));
}

void Session::AskControl() {
  const std::lock_guard lock(mutex_);
  v1::InteractRequest request;
  request.mutable_ask_control();
  Send(std::move(request));
}

void Session::GiveControl(std::uint64_t viewer_id) {
  const std::lock_guard lock(mutex_);
  v1::InteractRequest request;
  request.mutable_give_control()->set_viewer_id(viewer_id);
  Send(std::move(request));
}

void Session::RefuseControl(std::uint64_t viewer_id) {
  const std::lock_guard lock(mutex_);
  v1::InteractRequest request;
  request.mutable_refuse_control()->set_viewer_id(viewer_id);
  Send(std::move(request));
}

void Session::TakeControl() {
  const std::lock_guard lock(mutex_);
  v1::InteractRequest request;
  request.mutable_take_control();
  Send(std::move(request));
}

void Session::SetRules(const v1::SessionRules& rules) {
  const std::lock_guard lock(mutex_);
  v1::InteractRequest request;
  *request.mutable_set_rules()->mutable_rules() = rules;
  Send(std::move(request));
}

void Session::RetryNow() {
  const std::lock_guard lock(mutex_);
  retry_now_ = state_.link != Link::kLive;
  changed_.notify_all();
}

void Session::OpenAnother() {
  const std::lock_guard lock(mutex_);
  if (state_.link != Link::kGone) return;
  LeaveSession();
  state_.looks_around = false;
  retry_now_ = true;
  changed_.notify_all();
}

}  // namespace thunderhead::client
