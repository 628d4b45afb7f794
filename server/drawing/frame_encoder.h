// Encodes sessions' frames as JPEG and video on separate threads, and publishes them in the order
// in which they were drawn. Resting frames are published later (resting_frame_encoder.h). The
// render loop submits at most two frames of a session at a time, which bounds the queue.
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

#include "base/time_source.h"
#include "drawing/frame_source.h"
#include "drawing/resting_frame_encoder.h"
#include "scene/view.h"
#include "session/sessions.h"

namespace thunderhead::drawing {

// A frame drawn for a session.
struct DrawnFrame {
  std::shared_ptr<session::Session> session;
  std::uint64_t scene_revision = 0;
  scene::Scene scene;
  bool refined = false;
  // When the scene counts as at rest, unless it changes earlier.
  session::Clock::time_point rests_at;
  DisplayFrame picture;
  std::optional<frame::FineImage> fine;  // set if viewers take resting frames
  // Set if the Monte Carlo reference drew the picture.
  std::optional<delivery::Refinement> refinement;
  scene::View view;
};

class FrameEncoder {
 public:
  static constexpr int kMaxPending = 2;

  // `on_encoded` is called on an encoding thread when a frame has been published. The memory of
  // video encoders is reserved in `memory`.
  FrameEncoder(int threads, SerializeFrame serialize, std::shared_ptr<base::MemoryBudget> memory,
               std::function<void()> on_encoded, const base::TimeSource& time = base::SteadyTime());
  // Waits for the frames being encoded and drops the queued ones.
  ~FrameEncoder();
  FrameEncoder(const FrameEncoder&) = delete;
  FrameEncoder& operator=(const FrameEncoder&) = delete;

  void Encode(DrawnFrame frame);
  // Returns true if the session has the maximum number of pending frames.
  bool IsFullFor(const session::Session& session);

 private:
  void Run();
  std::deque<DrawnFrame>::iterator NextFrame();  // needs mutex_

  const SerializeFrame serialize_;
  const std::shared_ptr<base::MemoryBudget> memory_;
  const std::function<void()> on_encoded_;
  const base::TimeSource& time_;
  RestingFrameEncoder resting_frames_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool stopping_ = false;
  std::deque<DrawnFrame> waiting_;
  // Sessions one of whose frames is being encoded. At most one frame per session is encoded at a
  // time, which keeps the frames in order.
  std::vector<const session::Session*> encoding_;
  std::vector<std::thread> threads_;
};

}  // namespace thunderhead::drawing
