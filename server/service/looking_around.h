// A person's own view in one call: the session's scene from the person's own camera. Cameras take
// effect in the order of their requests, even if some wait for the storm's fields. Safe to call
// from any thread.
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

  // Registers a request for a camera and returns its number, for LookFrom. If it `detaches`, the
  // view is pending until EndDetach.
  std::uint64_t Begin(bool detaches);
  void EndDetach();
  // Returns true if there is a view or a pending one.
  bool Looks() const;

  // Moves the view to the camera of the newest request, which may be newer than `camera`. Without a
  // view, `open` opens one. If `open` is null, the camera is kept for the pending view.
  void LookFrom(std::uint64_t look, const scene::Camera& camera, const Open& open);
  // Returns the session that draws the view, or null without a view. Closes the view first if its
  // person `follows` the session's view again.
  std::shared_ptr<session::Session> Drawn(const std::function<bool()>& follows);

 private:
  mutable std::mutex mutex_;
  std::shared_ptr<session::OwnView> view_;
  int detaching_ = 0;                    // pending requests for a view
  std::uint64_t looks_ = 0;              // requests for a camera
  std::uint64_t looked_ = 0;             // the newest request that has taken effect
  std::optional<scene::Camera> camera_;  // the camera of that request
};

}  // namespace thunderhead::service
