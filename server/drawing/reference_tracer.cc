#include "drawing/reference_tracer.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/guarded.h"
#include "base/status.h"
#include "base/stopwatch.h"
#include "base/thread_priority.h"
#include "drawing/reference_schedule.h"
#include "reference/scene_problem.h"

namespace thunderhead::drawing {
namespace {

// Duration of one owner's turn, in seconds.
constexpr double kTurn_s = 0.25;

// Memory for mean and variance of the radiance, for opacity and distance, and for a picture that
// waits to be shown.
constexpr std::size_t kTracedBytesPerPixel = 160;

std::size_t BytesFor(const volume::HydrometeorFields& fields, const glm::ivec2& size_px) {
  return static_cast<std::size_t>(size_px.x) * static_cast<std::size_t>(size_px.y) *
             kTracedBytesPerPixel +
         reference::MediumBytes(fields, false);
}

}  // namespace

// A picture that is being traced. Only the tracing thread uses it, except for `stop`.
struct ReferenceTracer::Job {
  Job(std::string of_owner, std::shared_ptr<const scene::Scene> of_scene,
      std::shared_ptr<const volume::HydrometeorFields> of_fields, const Owned& of,
      const base::TimeSource& by_time)
      : owner(std::move(of_owner)),
        scene(std::move(of_scene)),
        fields(std::move(of_fields)),
        source(of.source),
        reserved(of.reserved),
        time(by_time),
        schedule({scene->output.width_px, scene->output.height_px}),
        shown_at(by_time.Now()) {}

  // The result of a turn: a picture if one is due, and whether this picture is the last.
  struct Turn {
    Found found;
    bool ended = false;
  };
  // Refines the picture for one turn. An error ends the job.
  absl::StatusOr<Turn> Refine(base::MemoryBudget& memory);

  const std::string owner;
  const std::shared_ptr<const scene::Scene> scene;
  const std::shared_ptr<const volume::HydrometeorFields> fields;
  const std::shared_ptr<ReferenceSource> source;
  const std::shared_ptr<base::MemoryReservation> reserved;
  const base::TimeSource& time;
  std::stop_source stop;
  ReferenceSchedule schedule;
  bool begun = false;
  double trace_ms = 0.0;
  base::TimeSource::Clock::time_point shown_at;
};

absl::StatusOr<ReferenceTracer::Job::Turn> ReferenceTracer::Job::Refine(
    base::MemoryBudget& memory) {
  const base::Stopwatch stopwatch;
  if (!begun) {
    THUNDERHEAD_RETURN_IF_ERROR(memory.Resize(*reserved, BytesFor(*fields, schedule.SizePx()),
                                              "a picture by the reference"));
    THUNDERHEAD_RETURN_IF_ERROR(source->Begin(*scene, fields, schedule.SizePx()));
    begun = true;
  }
  const delivery::Refinement refinement =
      source->Refine(schedule.UntilSamples(), kTurn_s, stop.get_token());
  trace_ms += stopwatch.ElapsedMs();
  if (stop.stop_requested()) return Turn{std::nullopt, true};
  Found found;
  const bool full_size = schedule.IsFull();
  if (schedule.ShowNow(refinement, base::MsSince(time, shown_at) * 1e-3)) {
    found = std::make_shared<const ReferencePicture>(
        ReferencePicture{source->Snapshot(), refinement, trace_ms, full_size});
    shown_at = time.Now();
  }
  if (schedule.GrowAt(refinement)) begun = false;
  return Turn{std::move(found), full_size && schedule.Finished(refinement)};
}

ReferenceTracer::ReferenceTracer(ReferenceSourceFactory make_source, std::size_t max_owners,
                                 std::shared_ptr<base::MemoryBudget> memory,
                                 std::function<void()> on_picture, const base::TimeSource& time)
    : make_source_(std::move(make_source)),
      max_owners_(max_owners),
      memory_(std::move(memory)),
      on_picture_(std::move(on_picture)),
      time_(time),
      thread_([this] { Run(); }) {}

ReferenceTracer::~ReferenceTracer() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
    for (auto& [owner, owned] : owned_) {
      if (owned.job != nullptr) owned.job->stop.request_stop();
    }
  }
  changed_.notify_one();
  thread_.join();
}

absl::Status ReferenceTracer::Trace(const std::string& owner,
                                    std::shared_ptr<const scene::Scene> scene,
                                    std::shared_ptr<const volume::HydrometeorFields> fields) {
  Stop(owner);
  {
    const std::lock_guard lock(mutex_);
    if (owned_.count(owner) == 0 && owned_.size() >= max_owners_) {
      return absl::ResourceExhaustedError(
          absl::StrCat("the server is already tracing ", owned_.size(),
                       " pictures by the reference; choose another technique, or try again later"));
    }
    Owned& owned = owned_[owner];
    if (owned.source == nullptr) {
      owned.source = make_source_();
      owned.reserved = std::make_shared<base::MemoryReservation>(
          *memory_->Reserve(base::MemoryUse::kTracing, 0, "a picture by the reference"));
    }
    owned.job = std::make_shared<Job>(owner, std::move(scene), std::move(fields), owned, time_);
  }
  changed_.notify_one();
  return absl::OkStatus();
}

std::optional<absl::StatusOr<std::shared_ptr<const ReferencePicture>>> ReferenceTracer::Take(
    const std::string& owner) {
  const std::lock_guard lock(mutex_);
  const auto found = owned_.find(owner);
  if (found == owned_.end()) return std::nullopt;
  return std::exchange(found->second.found, std::nullopt);
}

void ReferenceTracer::Stop(const std::string& owner) {
  const std::lock_guard lock(mutex_);
  const auto found = owned_.find(owner);
  if (found == owned_.end()) return;
  found->second.found.reset();
  const std::shared_ptr<Job> job = std::exchange(found->second.job, nullptr);
  if (job != nullptr) job->stop.request_stop();
}

void ReferenceTracer::Forget(const std::string& owner) {
  Stop(owner);
  const std::lock_guard lock(mutex_);
  owned_.erase(owner);
}

// Returns the job of the next owner after the one that was served last (round robin).
std::shared_ptr<ReferenceTracer::Job> ReferenceTracer::NextJob() {
  const auto after_last = owned_.upper_bound(last_served_);
  const auto has_job = [](const auto& entry) { return entry.second.job != nullptr; };
  auto next = std::find_if(after_last, owned_.end(), has_job);
  if (next == owned_.end()) next = std::find_if(owned_.begin(), owned_.end(), has_job);
  return next == owned_.end() ? nullptr : next->second.job;
}

// Keeps the result for its owner, unless the owner's job has been replaced.
void ReferenceTracer::Keep(Job& job, Found found, bool ended) {
  {
    const std::lock_guard lock(mutex_);
    const auto entry = owned_.find(job.owner);
    if (entry == owned_.end() || entry->second.job.get() != &job) return;
    if (ended) entry->second.job.reset();
    if (!found.has_value()) return;
    entry->second.found = std::move(found);
  }
  on_picture_();
}

void ReferenceTracer::Run() {
  // This thread gets a low priority, which the threads that it starts inherit.
  base::LowerPriority(base::kLowestPriority);
  std::unique_lock lock(mutex_);
  while (true) {
    std::shared_ptr<Job> job;
    changed_.wait(lock, [&] { return stopping_ || (job = NextJob()) != nullptr; });
    if (stopping_) return;
    last_served_ = job->owner;
    lock.unlock();
    auto turn = base::Guarded([&] { return job->Refine(*memory_); });
    if (turn.ok()) {
      Keep(*job, std::move(turn->found), turn->ended);
    } else {
      Keep(*job, turn.status(), true);
    }
    // Frees the job's fields and pictures, which may take many megabytes, before taking the lock.
    job.reset();
    lock.lock();
  }
}

}  // namespace thunderhead::drawing
