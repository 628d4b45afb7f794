// A thread that draws alongside the render loop with its own frame source. A long drawing consists
// of pieces, and other work is drawn between two pieces. The worker uses the device only in turns
// that the render loop gives it, and the CPU at a low priority.
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

class Worker {
 public:
  // The work of a worker. It is called on the worker's thread with the worker's source, which is
  // created for the first work. If the source could not be created, it is called with the error.
  using Work = std::function<void(const absl::StatusOr<FrameSource*>& source)>;

  struct Limits {
    // If set to true, the work ends with CANCELLED before its next piece. Tracing checks the flag
    // after some rays (base::DeviceTurn::Wanted). The limits below are checked at the same points.
    std::shared_ptr<const std::atomic<bool>> cancelled = nullptr;
    // Maximum drawing time of all pieces. Beyond it, the work ends with RESOURCE_EXHAUSTED.
    double max_ms = 1e15;
    // Maximum time of the whole work, without the time spent waiting for turns. Beyond it, the work
    // ends with `too_long` before its next piece.
    double max_work_ms = 1e15;
    absl::Status too_long = absl::OkStatus();
  };

  // `on_change` is called on the worker's thread when the worker needs a turn or has finished its
  // work.
  Worker(FrameSourceFactory make_source, int niceness, std::function<void()> on_change,
         const base::TimeSource& time = base::SteadyTime());
  // Ends the work before its next piece and joins the thread.
  ~Worker();
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  // Returns true if the worker has no work.
  bool IsIdle() const;
  // Starts the work. The worker must be idle.
  void Begin(Work work, Limits limits);

  // If the worker is idle, frees what its source keeps but has not used during the last `unused_s`
  // seconds. Returns when the memory is freed.
  void FreeUnused(double unused_s);
  // Discards the source after the device was lost. The current work ends with gl::DeviceLost before
  // its next piece, and later work gets a new source.
  void RenewSource();

  // Returns true if the work waits to draw a piece. If work that waits must end instead, because it
  // was cancelled or has exceeded a limit, wakes it so that it ends, and returns false.
  bool WantsTurn();
  // Lets the worker draw a piece. Returns the time that the piece took, in milliseconds, once it is
  // drawn. Returns 0 at once if no piece waits.
  double GiveTurn();

  // Returns how long the worker has worked since its last piece: computing on the CPU, or in a call
  // that hangs. Returns 0 while the worker has no work or waits for its turn. Safe from any thread.
  double StalledSeconds() const;

 private:
  // Turns on the device for the worker's source.
  class Turn final : public base::DeviceTurn {
   public:
    explicit Turn(Worker& worker) : worker_(worker) {}
    absl::Status Take() override { return worker_.Take(); }
    void GiveBack() override { worker_.GiveBack(); }
    absl::Status Wanted() const override { return worker_.Wanted(); }

   private:
    Worker& worker_;
  };

  enum class Device { kUnused, kWanted, kHeld };
  using Time = base::TimeSource::Clock::time_point;

  absl::Status Take();
  void GiveBack();
  absl::Status Wanted() const;
  // Returns the reason why the work must end; OK if it may continue. Needs mutex_.
  absl::Status Ended() const;
  // Returns the time of the current work so far, without waiting for turns. Needs mutex_.
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
  std::optional<double> frees_;  // requests that memory unused for this many seconds be freed
  Work work_;
  Limits limits_;
  bool busy_ = false;
  Device device_ = Device::kUnused;
  double used_ms_ = 0.0;    // device time of the current work
  double waited_ms_ = 0.0;  // time that the current work waited for turns
  Time begun_at_;
  Time wanted_at_;    // start of the wait for a turn
  Time progress_at_;  // time of the last piece or the end of the last wait
  std::thread thread_;
};

}  // namespace thunderhead::drawing
