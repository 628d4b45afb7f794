// The messages that wait to be written to a session. Some messages are sent in order. For the
// others only the newest message is kept. This is a plain value: its owner must lock it.
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

  // Appends a message, and keeps the order. Drops the message and returns false if too many wait.
  bool Send(v1::InteractRequest request);
  // Replaces the waiting camera or pointer. These are sent at most 30 times a second.
  void MoveCamera(const v1::Camera& camera) { camera_ = camera; }
  void PointTo(const v1::Point& point) { point_ = point; }
  // Replaces the waiting acknowledgement or window.
  void Acknowledge(const v1::Acknowledgement& acknowledgement);
  void Resize(const v1::Window& window) { window_ = window; }
  void DropCamera() { camera_.reset(); }
  // Drops all messages before a new call, which must not send those of the old call.
  void Clear() { *this = Outbox(); }

  std::optional<v1::InteractRequest> Next(TimePoint now);
  // Returns when a paced message may be sent; nothing if none waits.
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
