// A thread that draws alongside the render loop with its own frame source. A long drawing can stop
// between two pieces while others are drawn. The lane uses the device only in turns that the render
// loop gives it, and the CPU at a low priority.
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
  // Called on the lane's thread with its source, which is created for the first work, or with the
  // error of creating it.
  using Work = std::function<void(const absl::StatusOr<FrameSource*>& source)>;

  struct Limits {
    // If set to true, ends the work with CANCELLED at its next piece. Tracing ends within some rays
    // (base::DeviceTurn::Wanted). The limits below take effect at the same points.
    std::shared_ptr<const std::atomic<bool>> cancelled = nullptr;
    // Maximum drawing time of all its pieces. Beyond it, the work ends with RESOURCE_EXHAUSTED.
    double max_ms = 1e15;
    // Maximum time of all its work, without waiting for turns. Beyond it, the work ends with
    // `too_long` at its next piece.
    double max_work_ms = 1e15;
    absl::Status too_long = absl::OkStatus();
  };

  // `on_change` is called on the lane's thread when the lane needs a turn or has finished its work.
  Lane(FrameSourceFactory make_source, int niceness, std::function<void()> on_change,
       const base::TimeSource& time = base::SteadyTime());
  // Ends the work at its next piece.
  ~Lane();
  Lane(const Lane&) = delete;
  Lane& operator=(const Lane&) = delete;

  // Returns true if the lane has no work.
  bool IsIdle() const;
  // Starts the work. The lane must be idle.
  void Begin(Work work, Limits limits);

  // If the lane is idle, frees what its source keeps and has not used for that long. Returns when
  // that is done.
  void FreeUnused(double unused_s);
  // Replaces the source after the device was lost. Ends the current work with gl::DeviceLost at its
  // next piece; later work gets another source.
  void RenewSource();

  // Returns true if the work waits to draw a piece. Also lets cancelled work run to its end.
  bool WantsTurn();
  // Lets the lane draw a piece. Returns when it is drawn, with the milliseconds that it took.
  double GiveTurn();

  // Returns how long the lane has worked since its last piece, on the CPU or in a call that hangs.
  // Returns 0 while it has no work or waits for its turn. Safe from any thread.
  double StalledSeconds() const;

 private:
  // Turns on the device for the lane's source.
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
  // Returns why the work must end; OK if it must not. Needs mutex_.
  absl::Status Ended() const;
  // Returns the working time of the current work without waiting. Needs mutex_.
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
  std::optional<double> frees_;  // request to free what was unused for this many seconds
  Work work_;
  Limits limits_;
  bool busy_ = false;
  Device device_ = Device::kUnused;
  double used_ms_ = 0.0;    // device time of the current work
  double waited_ms_ = 0.0;  // time that the current work waited for turns
  Time begun_at_;
  Time wanted_at_;    // start of the wait for a turn
  Time progress_at_;  // last piece or wait
  std::thread thread_;
};

}  // namespace thunderhead::drawing
