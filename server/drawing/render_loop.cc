#include "drawing/render_loop.h"

#include <algorithm>
#include <exception>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "base/error_details.h"
#include "base/guarded.h"
#include "base/status.h"
#include "base/thread_priority.h"
#include "drawing/guarded_source.h"
#include "drawing/image_drawer.h"
#include "drawing/light_tracer.h"
#include "drawing/measured_source.h"
#include "drawing/session_drawer.h"
#include "drawing/session_worker.h"
#include "drawing/turns.h"
#include "drawing/worker.h"
#include "gl/device_faults.h"
#include "spdlog/spdlog.h"
#include "telemetry/metrics.h"

namespace thunderhead::drawing {
namespace {

// Niceness of the workers that draw single pictures. They yield to sessions' frames, for which
// viewers wait. Tracing yields to them, because it could use all CPU cores indefinitely.
constexpr int kImageNiceness = 5;
// Niceness of the worker that draws frames at rest, which yields to frames of changing scenes.
constexpr int kSessionNiceness = 1;

// The workers that draw alongside the render loop.
class Workers {
 public:
  struct Entry {
    std::string name;  // sorts before all session ids
    TurnClass turn_class;
    Worker& worker;
  };

  Workers(const FrameSourceFactory& make_source, bool yield, const std::function<void()>& wake,
          const base::TimeSource& time)
      : sessions(make_source, yield ? kSessionNiceness : 0, wake, time),
        tracing(make_source, yield ? base::kLowestPriority : 0, wake, time),
        quick_images(make_source, yield ? kImageNiceness : 0, wake, time),
        images(make_source, yield ? kImageNiceness : 0, wake, time),
        all_{{"/tracing", TurnClass::kRefining, tracing},
             {"/quick images", TurnClass::kBatch, quick_images},
             {"/images", TurnClass::kBatch, images}} {}

  // Returns the workers that compete for turns as contenders of their own. The sessions' worker is
  // not among them: the session whose frame it draws competes instead.
  const std::vector<Entry>& All() const { return all_; }

  Worker sessions;
  Worker tracing;
  Worker quick_images;
  Worker images;

 private:
  const std::vector<Entry> all_;
};

// The GL objects of a scene that was last drawn within this time are kept, because a viewer may
// return to it.
constexpr double kUnused_s = 3.0;
constexpr std::chrono::milliseconds kBetweenAnswers{500};

RenderLoopOptions WithBudget(RenderLoopOptions options) {
  if (options.memory == nullptr) options.memory = base::MemoryBudget::Unlimited();
  return options;
}

// Frees unused memory when a budget has refused a reservation. It listens for refusals as long as
// it exists.
class MemoryPressure {
 public:
  using Budgets = std::vector<std::shared_ptr<base::MemoryBudget>>;

  MemoryPressure(const Budgets& budgets, base::WakeSignal& wake, const base::TimeSource& time)
      : budgets_(budgets), time_(time), seen_(budgets.size()) {
    for (const auto& budget : budgets_) budget->OnPressure([&wake] { wake.Notify(); });
  }
  ~MemoryPressure() {
    for (const auto& budget : budgets_) budget->OnPressure({});
  }
  MemoryPressure(const MemoryPressure&) = delete;
  MemoryPressure& operator=(const MemoryPressure&) = delete;

  template <typename FreeUnused>
  void Answer(const FreeUnused& free_unused) {
    bool has_grown = false;
    for (std::size_t i = 0; i < budgets_.size(); ++i) {
      const std::uint64_t refusals = budgets_[i]->Refusals();
      has_grown = has_grown || std::exchange(seen_[i], refusals) != refusals;
    }
    if (!has_grown) return;
    if (time_.Now() >= next_) {
      free_unused();
      next_ = time_.Now() + kBetweenAnswers;
    }
    for (std::size_t i = 0; i < budgets_.size(); ++i) budgets_[i]->Answer(seen_[i]);
  }

 private:
  const Budgets& budgets_;
  const base::TimeSource& time_;
  std::vector<std::uint64_t> seen_;
  session::Clock::time_point next_{};
};

std::optional<session::Clock::time_point> Earlier(
    const std::optional<session::Clock::time_point>& a,
    const std::optional<session::Clock::time_point>& b) {
  if (!a.has_value()) return b;
  if (!b.has_value()) return a;
  return std::min(*a, *b);
}

}  // namespace

absl::StatusOr<std::unique_ptr<RenderLoop>> RenderLoop::Start(
    const RenderLoopOptions& options, storm_store::StormStore& store, session::Sessions& sessions,
    base::WakeSignal& wake, const FrameSourceFactory& make_source) {
  std::unique_ptr<RenderLoop> loop(new RenderLoop(options, store, sessions, wake));
  std::promise<absl::Status> started;
  std::future<absl::Status> status = started.get_future();
  loop->thread_ =
      std::thread([raw = loop.get(), make_source, promise = std::move(started)]() mutable {
        raw->Run(make_source, std::move(promise));
      });
  THUNDERHEAD_RETURN_IF_ERROR(status.get());
  return loop;
}

RenderLoop::RenderLoop(const RenderLoopOptions& options, storm_store::StormStore& store,
                       session::Sessions& sessions, base::WakeSignal& wake)
    : options_(WithBudget(options)),
      store_(store),
      sessions_(sessions),
      wake_(wake),
      time_(sessions.time()),
      losses_(options.losses),
      images_(options.max_waiting_images, options.max_waiting_images_each),
      reader_(std::make_unique<FieldsReader>(store, [&wake] { wake.Notify(); })),
      encoder_(std::make_unique<FrameEncoder>(
          options.encoder_threads, options.serialize_frame, options_.memory,
          [&wake] { wake.Notify(); }, time_)),
      tracer_(std::make_unique<ReferenceTracer>(
          options.make_reference_source, options.max_traced_sessions, options_.memory,
          [&wake] { wake.Notify(); }, time_)) {}

RenderLoop::~RenderLoop() { Stop(); }

double RenderLoop::TurnSeconds() const {
  const session::Clock::rep began = turn_began_;
  if (began == 0) return 0.0;
  const session::Clock::duration took =
      time_.Now().time_since_epoch() - session::Clock::duration(began);
  return std::chrono::duration<double>(took).count();
}

void RenderLoop::NoteWorkers(std::vector<const Worker*> workers) {
  const std::lock_guard lock(workers_mutex_);
  workers_ = std::move(workers);
}

double RenderLoop::StalledSeconds() const {
  const std::lock_guard lock(workers_mutex_);
  double stalled_s = 0.0;
  for (const Worker* worker : workers_) stalled_s = std::max(stalled_s, worker->StalledSeconds());
  return stalled_s;
}

void RenderLoop::RequestStop() {
  stopping_ = true;
  wake_.Notify();
}

void RenderLoop::Stop() {
  RequestStop();
  if (thread_.joinable()) thread_.join();
  reader_.reset();
  tracer_.reset();
  encoder_.reset();
}

void RenderLoop::RenderImage(ImageJob job) {
  if (images_.Add(std::move(job))) wake_.Notify();
}

void RenderLoop::Run(const FrameSourceFactory& make_unguarded, std::promise<absl::Status> started) {
  const FrameSourceFactory make_source =
      GuardedSources(make_unguarded, {.memory = options_.memory,
                                      .generation = device_generation_,
                                      .on_device_lost = [this](std::uint64_t generation) {
                                        if (generation != device_generation_)
                                          return;  // the loss is already known
                                        device_lost_ = true;
                                        wake_.Notify();
                                      }});
  auto source = make_source(nullptr);
  if (source.ok()) {
    device_ = (*source)->Device();
    techniques_ = (*source)->Techniques();
    preparation_ = (*source)->PreparationOfScenes();
  }
  bool is_ready = !source.ok();
  if (is_ready) started.set_value(source.status());
  try {
    if (source.ok()) {
      DrawWith(*std::move(source), make_source, [&] {
        is_ready = true;
        started.set_value(absl::OkStatus());
      });
    }
  } catch (const std::exception&) {
    if (is_ready) throw;
    started.set_value(base::Guarded([]() -> absl::Status { throw; }));
  }
  images_.RefuseAll();
}

void RenderLoop::DrawWith(std::unique_ptr<FrameSource> source,
                          const FrameSourceFactory& make_source,
                          const std::function<void()>& on_ready) {
  MeasuredSource measured(std::move(source), options_.offer_tables(), time_);
  const auto wake = [this] { wake_.Notify(); };
  auto workers = std::make_unique<Workers>(make_source, options_.workers_yield, wake, time_);
  LightTracer light_tracer(workers->tracing);
  SessionWorker session_worker(workers->sessions, [this](std::uint64_t bytes) {
    return std::ranges::all_of(options_.device_memory,
                               [bytes](const auto& budget) { return budget->HasRoom(bytes); });
  });
  SessionDrawer drawer(options_.targets, {store_, *reader_, preparation_}, measured, *encoder_,
                       *tracer_, light_tracer, session_worker,
                       {.picture_bytes = options_.memory->Bytes() / 2,
                        .references = std::max<std::size_t>(1, options_.max_traced_sessions / 2)},
                       time_);
  ImageDrawer image_drawer(options_.image_limits, images_, measured, preparation_, light_tracer,
                           {workers->quick_images, workers->images}, time_);
  Turns turns;
  MemoryPressure pressure(options_.device_memory, wake_, time_);
  const std::vector<Worker*> all_workers{&workers->sessions, &workers->tracing,
                                         &workers->quick_images, &workers->images};
  NoteWorkers({all_workers.begin(), all_workers.end()});
  on_ready();
  while (!stopping_) {
    BeginTurn();
    if (device_lost_.exchange(false)) {
      if (!Recover(make_source, all_workers, measured)) break;
      drawer.DeviceReplaced();
    }
    pressure.Answer([&] {
      // The last frame of the sessions' worker is freed first, because the render loop can draw it
      // again.
      if (session_worker.IsFree() && session_worker.Last().has_value()) {
        session_worker.Forget();
        workers->sessions.FreeUnused(0.0);
        return base::GiveBackFreedMemory();
      }
      drawer.YieldMemory(sessions_.AllDrawn());
      measured.FreeUnused(kUnused_s);
      for (Worker* worker : all_workers) worker->FreeUnused(kUnused_s);
      base::GiveBackFreedMemory();
    });
    BeginTurn();
    const std::vector<std::shared_ptr<session::Session>> sessions = sessions_.AllDrawn();
    drawer.ReleaseUnwatched(sessions);
    drawer.TakeDrawn(sessions);
    light_tracer.TakeOutcome(time_.Now());
    image_drawer.Attend();
    std::optional<session::Clock::time_point> look_again_at;
    std::vector<Contender> contenders;
    contenders.reserve(sessions.size() + workers->All().size());
    for (const auto& session : sessions) {
      const SessionDrawer::PendingWork pending = drawer.Look(session);
      contenders.push_back({session->id(), session->IsOwnView(), pending.work});
      look_again_at = Earlier(look_again_at, pending.look_again_at);
    }
    // The light tracer begins its step after all sessions were asked for their work, because a
    // session may just have requested light.
    look_again_at = Earlier(look_again_at, light_tracer.Begin(time_.Now()));
    for (const Workers::Entry& entry : workers->All()) {
      contenders.push_back({entry.name, false, std::nullopt});
      if (entry.worker.WantsTurn()) contenders.back().work = entry.turn_class;
    }
    const std::optional<std::size_t> next = turns.Next(contenders);
    if (!next.has_value()) {
      turn_began_ = 0;
      if (!look_again_at.has_value() || *look_again_at > time_.Now()) {
        wake_.Wait(look_again_at, time_);
      }
      continue;
    }
    const session::Clock::time_point given_at = time_.Now();
    if (*next < sessions.size()) {
      drawer.TakeTurn(sessions[*next]);
    } else {
      workers->All()[*next - sessions.size()].worker.GiveTurn();
    }
    turns.Used(contenders[*next], base::MsSince(time_, given_at));
    turn_began_ = 0;
  }
  NoteWorkers({});
  workers.reset();
  image_drawer.EndAll(base::ShuttingDown());
}

bool RenderLoop::Recover(const FrameSourceFactory& make_source, const std::vector<Worker*>& workers,
                         MeasuredSource& source) {
  recovering_ = true;
  absl::Status why = gl::DeviceLost();
  while (!stopping_) {
    telemetry::Counted().device_losses.Add();
    const std::optional<session::Clock::time_point> at = losses_.Lost(time_.Now());
    if (!at.has_value()) {
      why = absl::UnavailableError(
          absl::StrCat("the device was lost too often and is not opened again: ", why.message()));
      spdlog::critical("{}", std::string(why.message()));
      if (options_.on_device_given_up) options_.on_device_given_up(why);
      return false;
    }
    // Objects of a lost context must be deleted before a new context is created.
    ++device_generation_;
    for (Worker* worker : workers) worker->RenewSource();
    source.Replace(nullptr);
    const double pause_s = std::chrono::duration<double>(*at - time_.Now()).count();
    spdlog::error("the device was lost; opening it again in {:.1f} s", std::max(pause_s, 0.0));
    turn_began_ = 0;
    while (!stopping_ && time_.Now() < *at) wake_.Wait(*at, time_);
    if (stopping_) return false;
    // A driver can hang here just as it can while drawing, so this time is measured like a turn.
    BeginTurn();
    auto made = make_source(nullptr);
    if (made.ok()) {
      source.Replace(*std::move(made));
      recovering_ = false;
      return true;
    }
    why = made.status();
    spdlog::error("the device cannot be opened: {}", std::string(why.message()));
  }
  return false;
}

}  // namespace thunderhead::drawing
