// A person's own view in one call: the session's scene from a camera of theirs. Cameras take effect
// in the order in which they were asked for, though some wait for the storm's fields. Safe to call
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

  // A request for a camera has come: its number, for LookFrom. After one that `detaches` the view
  // is on its way until EndDetach.
  std::uint64_t Begin(bool detaches);
  void EndDetach();
  // True if there is a view, or one is on its way.
  bool Looks() const;

  // Moves the view to the newest camera asked for, which may be a later one than `camera`. Without
  // a view `open` opens it; if that is null the camera is kept for the one that is coming.
  void LookFrom(std::uint64_t look, const scene::Camera& camera, const Open& open);
  // The session that draws the view; null without one. Closes the view first if its person
  // `follows` the session's again.
  std::shared_ptr<session::Session> Drawn(const std::function<bool()>& follows);

 private:
  mutable std::mutex mutex_;
  std::shared_ptr<session::OwnView> view_;
  int detaching_ = 0;                    // requests on their way to a view
  std::uint64_t looks_ = 0;              // requests for its camera
  std::uint64_t looked_ = 0;             // the newest that has taken effect
  std::optional<scene::Camera> camera_;  // of that
};

}  // namespace thunderhead::service
