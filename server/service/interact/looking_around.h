// A person's own view in one Interact call: the session's scene from the person's own camera.
// Camera requests take effect in the order in which they arrived, even if some of them wait for the
// storm's fields. Safe to call from any thread.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>

#include "session/sessions.h"

namespace thunderhead::service {

class LookingAround {
 public:
  using Open = std::function<std::shared_ptr<session::OwnView>(const scene::Camera& first)>;

  // Registers a request for a camera and returns its number, for LookFrom. If `detaches` is true,
  // the view is pending until EndDetach.
  std::uint64_t Begin(bool detaches);
  void EndDetach();
  // Returns true if the person has an own view or has requested one.
  bool Looks() const;

  // Moves the view to `camera`, the camera of request number `look`. If a newer request has already
  // taken effect, its camera is used instead. If there is no view, `open` opens one. If there is no
  // view and `open` is null, the camera is kept for the pending view.
  void LookFrom(std::uint64_t look, const scene::Camera& camera, const Open& open);
  // Returns the session that draws the view, or null if there is no view. First closes the view if
  // `follows` returns true: the person sees the session's view again.
  std::shared_ptr<session::Session> Drawn(const std::function<bool()>& follows);

 private:
  mutable std::mutex mutex_;
  std::shared_ptr<session::OwnView> view_;
  int detaching_ = 0;                    // number of pending requests for a view
  std::uint64_t looks_ = 0;              // number of requests for a camera so far
  std::uint64_t looked_ = 0;             // number of the newest request that has taken effect
  std::optional<scene::Camera> camera_;  // camera of request looked_
};

}  // namespace thunderhead::service
