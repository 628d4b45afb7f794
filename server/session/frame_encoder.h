// Encodes sessions' frames as JPEG beside the thread that draws, and publishes them in the order in
// which they were drawn. The render loop keeps at most two frames of a session here, so nothing
// queues without bound.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "session/frame_source.h"
#include "session/sessions.h"

namespace thunderhead::session {

// A frame drawn for a session.
struct DrawnFrame {
  std::shared_ptr<Session> session;
  std::uint64_t scene_revision = 0;
  scene::Scene scene;
  bool refined = false;
  DisplayFrame picture;
  std::optional<Refinement> refinement;  // of a picture by the reference
};

class FrameEncoder {
 public:
  static constexpr int kMaxPending = 2;

  // `on_encoded` is called on an encoding thread when a frame has been published.
  FrameEncoder(int threads, std::function<void()> on_encoded);
  // Waits for the frames being encoded; those that wait are dropped.
  ~FrameEncoder();
  FrameEncoder(const FrameEncoder&) = delete;
  FrameEncoder& operator=(const FrameEncoder&) = delete;

  void Encode(DrawnFrame frame);
  // True if the session has as many frames here as it may.
  bool IsFullFor(const Session& session);

 private:
  void Run();
  std::deque<DrawnFrame>::iterator NextFrame();  // needs mutex_

  const std::function<void()> on_encoded_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool stopping_ = false;
  std::deque<DrawnFrame> waiting_;
  std::vector<const Session*>
      encoding_;  // whose frames are being encoded: one each, which keeps their order
  std::vector<std::thread> threads_;
};

}  // namespace thunderhead::session
