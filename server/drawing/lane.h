// A thread that draws beside the render loop, with a frame source of its own, so that a picture
// that takes long can stop between two pieces while others are drawn. It uses the device only in
// turns that the render loop gives it, and the processors at a low priority.
#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "base/device_turn.h"
#include "base/time_source.h"
#include "drawing/frame_source.h"

namespace thunderhead::drawing {

class Lane {
 public:
  // Called on the lane's thread with its source, which is made for the first work, or why there is
  // none.
  using Work = std::function<void(const absl::StatusOr<FrameSource*>& source)>;

  struct Limits {
    // True ends the work at its next piece, or where it traces within some rays
    // (base::DeviceTurn::Wanted), with CANCELLED. So do the others.
    std::shared_ptr<const std::atomic<bool>> cancelled = nullptr;
    // Of all its pieces; more ends it with RESOURCE_EXHAUSTED.
    double max_ms = 1e15;
    // Of all that it does, without waiting for its turn; more ends it with `too_long` at its next
    // piece.
    double max_work_ms = 1e15;
    absl::Status too_long = absl::OkStatus();
  };

  // `on_change` is called on the lane's thread when it wants a turn or has done its work.
  Lane(FrameSourceFactory make_source, int niceness, std::function<void()> on_change,
       const base::TimeSource& time = base::SteadyTime());
  // Ends the work at its next piece.
  ~Lane();
  Lane(const Lane&) = delete;
  Lane& operator=(const Lane&) = delete;

  // No work.
  bool IsIdle() const;
  // The lane must be idle.
  void Begin(Work work, Limits limits);

  // Gives back what its source keeps and has not drawn for so long, if the lane is idle; returns
  // when that is done.
  void FreeUnused(double unused_s);
  // Ends the work, at its next piece, with gl::DeviceLost, and makes another source for what comes
  // then: the device was lost.
  void RenewSource();

  // True if its work waits to draw a piece. Lets work that was cancelled go on to its end.
  bool WantsTurn();
  // Returns when the piece is drawn, with the milliseconds that it took.
  double GiveTurn();

  // For how long it has worked, on the processor or in a call that hangs, since its last piece; 0
  // while it has no work or waits for its turn. Safe from any thread.
  double StalledSeconds() const;

 private:
  // The source's turn at the device.
  class Turn final : public base::DeviceTurn {
   public:
    explicit Turn(Lane& lane) : lane_(lane) {}
    absl::Status Take() override { return lane_.Take(); }
    void GiveBack() override { lane_.GiveBack(); }
    absl::Status Wanted() const override { return lane_.Wanted(); }

   private:
    Lane& lane_;
  };

  enum class Device { kUnused, kWanted, kHeld };
  using Time = base::TimeSource::Clock::time_point;

  absl::Status Take();
  void GiveBack();
  absl::Status Wanted() const;
  // Why the work is to end; OK if it is not. With the mutex held.
  absl::Status Ended() const;
  // Of this work, without waiting. With the mutex held.
  double WorkedMs() const;
  void Run();

  const FrameSourceFactory make_source_;
  const int niceness_;
  const std::function<void()> on_change_;
  const base::TimeSource& time_;
  Turn turn_{*this};

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool stopping_ = false;
  bool source_is_lost_ = false;
  std::optional<double> frees_;  // what is unused for this many seconds
  Work work_;
  Limits limits_;
  bool busy_ = false;
  Device device_ = Device::kUnused;
  double used_ms_ = 0.0;    // by this work
  double waited_ms_ = 0.0;  // by this work, for turns
  Time begun_at_;
  Time wanted_at_;    // the turn
  Time progress_at_;  // last
  std::thread thread_;
};

}  // namespace thunderhead::drawing
