#include "drawing/light_tracer.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/error_details.h"
#include "base/guarded.h"
#include "base/log.h"
#include "base/memory_budget.h"
#include "base/status.h"
#include "gl/device_faults.h"

namespace thunderhead::drawing {
namespace {

// Returns true if the failure may pass, because other work now uses what the step needs.
bool MayPass(const absl::Status& failed) {
  return absl::IsResourceExhausted(failed) && !base::IsTooLargeForMemory(failed);
}

}  // namespace

void LightTracer::Want(const std::string& who, Request request) {
  Wanted& wanted = wanted_[who];
  if (wanted.request.scene == request.scene && wanted.request.fields == request.fields &&
      wanted.request.light == request.light && wanted.request.error == request.error) {
    return;
  }
  wanted = Wanted{.request = std::move(request), .claim = std::move(wanted.claim)};
}

void LightTracer::Stop(const std::string& who) { wanted_.erase(who); }

std::optional<absl::StatusOr<TracedStep>> LightTracer::TakeNews(const std::string& who) {
  const auto found = wanted_.find(who);
  if (found == wanted_.end()) return std::nullopt;
  return std::exchange(found->second.news, std::nullopt);
}

void LightTracer::TakeOutcome(session::Clock::time_point now) {
  if (outcome_ == nullptr || !worker_.IsIdle()) return;
  const std::shared_ptr<Outcome> outcome = std::exchange(outcome_, nullptr);
  const std::lock_guard lock(outcome->mutex);
  const auto found = wanted_.find(tracing_for_);
  if (found == wanted_.end() || found->second.request.scene != tracing_scene_) return;
  Wanted& wanted = found->second;
  if (wanted.request.claims && wanted.request.light) wanted.claim = std::move(outcome->claim);
  const absl::Status& failed = outcome->progress->status();
  if (MayPass(failed) || gl::IsDeviceLost(failed)) {
    wanted.not_before = now + kTraceAgainAfter;
    return;
  }
  wanted.ended = !outcome->progress->ok() || Ends(wanted.request, **outcome->progress);
  wanted.news = std::move(outcome->progress);
}

// Returns true if the request is complete. The request of a picture is complete at its requested
// number of paths and seconds. A session's request never is: the session calls Stop when it has
// enough paths.
bool LightTracer::Ends(const Request& request, const TracedStep& step) {
  const bool traces = step.light.has_value() && step.light->steps > 0 &&
                      !(request.claims && step.light->HasTraced(request.wanted_paths));
  const bool measures =
      request.error && !(step.error.has_value() && step.error->HasTraced(request.wanted_error_s));
  return !traces && !measures;
}

LightTracer::Progress LightTracer::Trace(FrameSource& source, const Request& request,
                                         accuracy::LightClaim* claim) {
  TracedStep step;
  if (request.light) {
    THUNDERHEAD_ASSIGN_OR_RETURN(
        step.light, source.TraceLight(*request.scene, request.fields, request.wanted_paths,
                                      request.claims ? claim : nullptr));
  }
  if (!request.error) return step;
  absl::StatusOr<accuracy::ErrorProgress> error =
      source.MeasureError(*request.scene, request.fields);
  if (error.ok()) {
    step.error = *std::move(error);
    return step;
  }
  // UNAVAILABLE means that the device was lost, or that the server is stopping. In both cases the
  // step fails.
  if (absl::IsUnavailable(error.status())) return error.status();
  // The picture can be shown without its error. A failure that may pass is retried with the next
  // step.
  if (MayPass(error.status())) {
    if (!request.light) return error.status();
    return step;
  }
  base::LogError(base::Annotate(
      error.status(), absl::StrCat("measuring the error of storm ", request.scene->storm_id)));
  step.error = accuracy::ErrorProgress{.ended = true};
  return step;
}

std::optional<session::Clock::time_point> LightTracer::Begin(session::Clock::time_point now) {
  if (!worker_.IsIdle() || outcome_ != nullptr) return std::nullopt;
  std::optional<session::Clock::time_point> again;
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
    worker_.Begin(
        [outcome = outcome_, request = wanted.request](const absl::StatusOr<FrameSource*>& source) {
          accuracy::LightClaim claim;
          Progress progress = base::Guarded([&]() -> Progress {
            if (!source.ok()) return source.status();
            return Trace(**source, request, &claim);
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

}  // namespace thunderhead::drawing
