#include "session/light_tracer.h"

#include <algorithm>
#include <utility>

#include "base/out_of_memory.h"
#include "gl/device_faults.h"

namespace thunderhead::session {

void LightTracer::Want(const std::string& who, Request request) {
  Wanted& wanted = wanted_[who];
  if (wanted.request.scene == request.scene && wanted.request.fields == request.fields) return;
  wanted = Wanted{.request = std::move(request), .claim = std::move(wanted.claim)};
}

void LightTracer::Stop(const std::string& who) { wanted_.erase(who); }

std::optional<absl::StatusOr<accuracy::LightProgress>> LightTracer::TakeNews(
    const std::string& who) {
  const auto found = wanted_.find(who);
  if (found == wanted_.end()) return std::nullopt;
  return std::exchange(found->second.news, std::nullopt);
}

void LightTracer::TakeOutcome(Clock::time_point now) {
  if (outcome_ == nullptr || !lane_.IsIdle()) return;
  const std::shared_ptr<Outcome> outcome = std::exchange(outcome_, nullptr);
  const std::lock_guard lock(outcome->mutex);
  const auto found = wanted_.find(tracing_for_);
  if (found == wanted_.end() || found->second.request.scene != tracing_scene_) return;
  Wanted& wanted = found->second;
  if (wanted.request.claims) wanted.claim = std::move(outcome->claim);
  const absl::Status& failed = outcome->progress->status();
  if (absl::IsResourceExhausted(failed) || gl::IsDeviceLost(failed)) {
    wanted.not_before = now + kTraceAgainAfter;
    return;
  }
  const Progress& progress = *outcome->progress;
  // A picture needs no more paths than it asked for; a session says when it has enough.
  wanted.ended = !progress.ok() || progress->steps == 0 ||
                 (wanted.request.claims && progress->HasTraced(wanted.request.wanted_paths));
  wanted.news = std::move(outcome->progress);
}

std::optional<Clock::time_point> LightTracer::Begin(Clock::time_point now) {
  if (!lane_.IsIdle() || outcome_ != nullptr) return std::nullopt;
  std::optional<Clock::time_point> again;
  auto next = wanted_.upper_bound(tracing_for_);
  for (std::size_t left = wanted_.size(); left > 0; --left, ++next) {
    if (next == wanted_.end()) next = wanted_.begin();
    const Wanted& wanted = next->second;
    if (wanted.ended) continue;
    if (wanted.not_before > now) {
      again = std::min(again.value_or(wanted.not_before), wanted.not_before);
      continue;
    }
    tracing_for_ = next->first;
    tracing_scene_ = wanted.request.scene;
    outcome_ = std::make_shared<Outcome>();
    lane_.Begin(
        [outcome = outcome_, request = wanted.request](const absl::StatusOr<FrameSource*>& source) {
          accuracy::LightClaim claim;
          Progress progress = base::OrOutOfMemory([&]() -> Progress {
            if (!source.ok()) return source.status();
            return (*source)->TraceLight(*request.scene, request.fields, request.wanted_paths,
                                         request.claims ? &claim : nullptr);
          });
          const std::lock_guard lock(outcome->mutex);
          outcome->progress = std::move(progress);
          outcome->claim = std::move(claim);
        },
        {});
    return std::nullopt;
  }
  return again;
}

}  // namespace thunderhead::session
