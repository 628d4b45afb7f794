// The messages that wait to be written to a session's stream. Requests are sent in order. Only the
// newest camera, pointer, window and, for each view, acknowledgement waits. The class has no lock,
// so its owner must synchronize access.
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

  // Appends a message to the queue. Drops the message and returns false if too many messages wait.
  bool Send(v1::InteractRequest request);
  // MoveCamera() and PointTo() replace the waiting camera or pointer. Each of the two is sent at
  // most 30 times a second.
  void MoveCamera(const v1::Camera& camera) { camera_ = camera; }
  void PointTo(const v1::Point& point) { point_ = point; }
  // Acknowledge() and Resize() replace the waiting acknowledgement or window. A waiting report of
  // lost video is kept.
  void Acknowledge(const v1::Acknowledgement& acknowledgement);
  void Resize(const v1::Window& window) { window_ = window; }
  void DropCamera() { camera_.reset(); }
  // Drops all messages. This is needed before a new call, which must not send the messages of the
  // old call.
  void Clear() { *this = Outbox(); }

  std::optional<v1::InteractRequest> Next(TimePoint now);
  // Returns when a waiting camera or pointer may be sent; nothing if neither waits.
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
