#include "service/interact/looking_around.h"

#include <utility>

namespace thunderhead::service {

std::uint64_t LookingAround::Begin(bool detaches) {
  const std::lock_guard lock(mutex_);
  if (detaches) ++detaching_;
  return ++looks_;
}

void LookingAround::EndDetach() {
  const std::lock_guard lock(mutex_);
  --detaching_;
}

bool LookingAround::Looks() const {
  const std::lock_guard lock(mutex_);
  return view_ != nullptr || detaching_ > 0;
}

void LookingAround::LookFrom(std::uint64_t look, const scene::Camera& camera, const Open& open) {
  std::unique_lock lock(mutex_);
  if (look > looked_) {
    looked_ = look;
    camera_ = camera;
  }
  if (view_ == nullptr && open != nullptr) {
    const std::uint64_t opened_for = looked_;
    const scene::Camera first = *camera_;
    lock.unlock();
    const std::shared_ptr<session::OwnView> opened = open(first);
    lock.lock();
    if (view_ == nullptr) view_ = opened;
    if (view_ == opened && opened_for == looked_) return;
  }
  const std::shared_ptr<session::OwnView> view = view_;
  const scene::Camera newest = *camera_;
  lock.unlock();
  if (view != nullptr) view->MoveCamera(newest);
}

std::shared_ptr<session::Session> LookingAround::Drawn(const std::function<bool()>& follows) {
  std::shared_ptr<session::OwnView> closed;  // destroyed after the mutex is released
  // The check and the exchange happen under one lock. Otherwise a person who leaves the session's
  // view again between the two would lose the new view.
  const std::lock_guard lock(mutex_);
  if (view_ != nullptr && follows()) closed = std::exchange(view_, nullptr);
  return view_ == nullptr ? nullptr : view_->drawn();
}

}  // namespace thunderhead::service
