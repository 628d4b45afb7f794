// The render loop. One thread draws the sessions that have a viewer ready for a frame. It also
// gives turns on the device to its workers, which draw long frames and single pictures and trace
// light. Reading, encoding and the Monte Carlo reference run on other threads. This code uses no
// message formats, and no GL: only the frame sources use GL.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "accuracy/offer_tables.h"
#include "base/memory_budget.h"
#include "base/time_source.h"
#include "base/wake_signal.h"
#include "drawing/device_losses.h"
#include "drawing/fields_reader.h"
#include "drawing/frame_encoder.h"
#include "drawing/frame_planner.h"
#include "drawing/frame_source.h"
#include "drawing/image_drawer.h"
#include "drawing/image_queue.h"
#include "drawing/reference_source.h"
#include "drawing/reference_tracer.h"
#include "session/sessions.h"

namespace thunderhead::drawing {

class Worker;
class MeasuredSource;

struct RenderLoopOptions {
  PlannerTargets targets;
  std::size_t max_waiting_images = 1000;
  std::size_t max_waiting_images_each = 600;  // maximum per owner
  ImageLimits image_limits;
  int encoder_threads = 1;
  // If true, workers and their threads run at a lower priority than frames of changing scenes. Set
  // it to false if no session is served. Otherwise, other programs on the machine would slow the
  // workers down.
  bool workers_yield = true;
  SerializeFrame serialize_frame = [](const delivery::EncodedFrame&) { return ""; };
  // Maximum number of sessions that show the Monte Carlo reference. Each uses about 160 bytes per
  // pixel, plus reference::MediumBytes of its storm's fields.
  std::size_t max_traced_sessions = 8;
  std::function<accuracy::OfferTables()> offer_tables = accuracy::BuiltInOfferTables;
  ReferenceSourceFactory make_reference_source = [] { return MakeReferenceSource(); };
  // The memory budget for pictures; null means no limit.
  std::shared_ptr<base::MemoryBudget> memory;
  // The budgets for GL objects. When a budget refuses a reservation, the sources free their caches.
  std::vector<std::shared_ptr<base::MemoryBudget>> device_memory;
  LossLimits losses;
  // Called once, on the loop's thread, when the device was lost too often. Afterwards nothing is
  // drawn.
  std::function<void(const absl::Status& why)> on_device_given_up;
};

class RenderLoop {
 public:
  // Starts the loop. Returns it once the frame source has been created, or the error. `sessions`
  // must call `wake.Notify()` when there is work. `store`, `sessions` and `wake` must outlive the
  // loop.
  static absl::StatusOr<std::unique_ptr<RenderLoop>> Start(const RenderLoopOptions& options,
                                                           storm_store::StormStore& store,
                                                           session::Sessions& sessions,
                                                           base::WakeSignal& wake,
                                                           const FrameSourceFactory& make_source);
  ~RenderLoop();
  RenderLoop(const RenderLoop&) = delete;
  RenderLoop& operator=(const RenderLoop&) = delete;

  const DeviceInfo& Device() const { return device_; }
  // Returns the techniques in the order in which to offer them.
  const std::vector<scene::TechniqueInfo>& Techniques() const { return techniques_; }

  void RenderImage(ImageJob job);

  // Returns the time that the current drawing turn, or the reopening of a lost device, has taken so
  // far, in seconds. Returns 0 while the loop waits for work.
  double TurnSeconds() const;

  // Returns true while the device is lost and not yet reopened.
  bool IsRecovering() const { return recovering_; }
  std::size_t WaitingImages() const { return images_.Waiting(); }

  // Returns how many seconds a worker has worked without drawing a piece or waiting for a turn: the
  // longest of all workers. Returns 0 while no worker works.
  double StalledSeconds() const;

  // Requests a stop after the current frame or piece. Returns without waiting.
  void RequestStop();
  // Waits for the current frame or piece, refuses the waiting pictures and joins all threads.
  void Stop();

 private:
  RenderLoop(const RenderLoopOptions& options, storm_store::StormStore& store,
             session::Sessions& sessions, base::WakeSignal& wake);

  void Run(const FrameSourceFactory& make_source, std::promise<absl::Status> started);
  // Calls `on_ready` before the first turn. Throws before that if a worker's thread cannot start.
  void DrawWith(std::unique_ptr<FrameSource> source, const FrameSourceFactory& make_source,
                const std::function<void()>& on_ready);
  void NoteWorkers(std::vector<const Worker*> workers);
  // Starts the time measurement of TurnSeconds.
  void BeginTurn() { turn_began_ = time_.Now().time_since_epoch().count(); }
  // Reopens the device after a loss. Returns true when it is open again, false if the loop gives
  // up.
  bool Recover(const FrameSourceFactory& make_source, const std::vector<Worker*>& workers,
               MeasuredSource& source);

  const RenderLoopOptions options_;
  storm_store::StormStore& store_;
  session::Sessions& sessions_;
  base::WakeSignal& wake_;
  const base::TimeSource& time_;  // the sessions' time source
  // device_, techniques_ and preparation_ are constant after Start.
  DeviceInfo device_;
  std::vector<scene::TechniqueInfo> techniques_;
  std::shared_ptr<Preparation> preparation_;
  std::atomic<bool> stopping_{false};
  std::atomic<std::uint64_t> device_generation_{0};  // number of devices opened so far
  std::atomic<bool> device_lost_{false};
  std::atomic<bool> recovering_{false};
  DeviceLosses losses_;
  // The time at which the current turn began, as a duration since the clock's epoch. 0 while there
  // is no turn.
  std::atomic<session::Clock::rep> turn_began_{0};

  mutable std::mutex workers_mutex_;
  std::vector<const Worker*> workers_;  // all existing workers

  ImageQueue images_;
  std::unique_ptr<FieldsReader> reader_;
  std::unique_ptr<FrameEncoder> encoder_;
  std::unique_ptr<ReferenceTracer> tracer_;
  std::thread thread_;
};

}  // namespace thunderhead::drawing
