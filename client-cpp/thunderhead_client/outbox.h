// The messages that wait to be written to a session: those whose order matters, and of those of
// which only the newest counts the newest. A plain value; whoever shares it locks it.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <optional>

#include "thunderhead/v1/interact.pb.h"

namespace thunderhead::client {

class Outbox {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;

  // In order. False, and dropped, where too many wait.
  bool Send(v1::InteractRequest request);
  // The newest wins; sent at most 30 times a second.
  void MoveCamera(const v1::Camera& camera) { camera_ = camera; }
  void PointTo(const v1::Point& point) { point_ = point; }
  // The newest wins.
  void Acknowledge(const v1::Acknowledgement& acknowledgement);
  void Resize(const v1::Window& window) { window_ = window; }
  void DropCamera() { camera_.reset(); }
  // For a new call: nothing of the old one is sent.
  void Clear() { *this = Outbox(); }

  std::optional<v1::InteractRequest> Next(TimePoint now);
  // When a paced message is due; nothing where none waits.
  std::optional<TimePoint> WakeAt() const;

 private:
  std::deque<v1::InteractRequest> ordered_;
  std::optional<v1::Acknowledgement> acknowledgement_;
  std::optional<v1::Acknowledgement> own_acknowledgement_;
  std::optional<v1::Window> window_;
  std::optional<v1::Camera> camera_;
  std::optional<v1::Point> point_;
  TimePoint camera_due_{};
  TimePoint point_due_{};
};

}  // namespace thunderhead::client
