#include "runs/watch_server.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <numeric>
#include <optional>
#include <set>

#include "absl/strings/str_cat.h"
#include "base/status.h"
#include "runs/job_run.h"
#include "runs/server_outage.h"

namespace thunderhead::runs {
namespace {

// Interval of checks. Each check is a call that reads no storm, unless there is a new time.
constexpr std::chrono::seconds kLook{2};

// Returns the number of the storm's times; nothing if the storm does not exist (yet).
absl::StatusOr<std::optional<int>> TimesOf(ServerLink& server, const std::string& id) {
  v1::ListStormsResponse listed;
  THUNDERHEAD_RETURN_IF_ERROR(server.Call(server.Service(),
                                          &v1::ThunderheadService::Stub::ListStorms,
                                          v1::ListStormsRequest(), &listed));
  const auto storm = std::ranges::find(listed.storms(), id, &v1::StormSummary::id);
  if (storm == listed.storms().end()) return std::nullopt;
  return static_cast<int>(storm->time_count());
}

void PauseForLook(const std::stop_token& stop) {
  std::mutex mutex;
  std::condition_variable_any stopped;
  std::unique_lock lock(mutex);
  stopped.wait_for(lock, stop, kLook, [] { return false; });
}

class Watching {
 public:
  Watching(const ServerWatch& watch, ServerLink& server, PictureRun& run, RunProgress& progress)
      : watch_(watch), server_(server), run_(run), progress_(progress) {}

  // Draws the times that were added since the last check.
  absl::Status Look(const std::stop_token& stop) {
    THUNDERHEAD_ASSIGN_OR_RETURN(const std::optional<int> times, TimesOf(server_, watch_.storm));
    if (!times.has_value() || times == seen_) return absl::OkStatus();
    THUNDERHEAD_ASSIGN_OR_RETURN(const v1::StormDescription storm,
                                 DescribeStorm(server_, watch_.storm));
    std::vector<int> all(static_cast<std::size_t>(storm.times_size()));
    std::iota(all.begin(), all.end(), 0);
    THUNDERHEAD_ASSIGN_OR_RETURN(std::vector<PlannedPicture> pictures,
                                 PlanOfServer(run_.Options(), server_, storm, 0, all, false));
    THUNDERHEAD_RETURN_IF_ERROR(CheckNames(run_.Options(), pictures));
    std::vector<PlannedPicture> fresh;
    for (const PlannedPicture& picture : pictures) {
      if (!settled_.contains(picture.path)) fresh.push_back(picture);
    }
    THUNDERHEAD_RETURN_IF_ERROR(MakeByJobs(server_, run_, fresh, progress_, stop));
    bool all_settled = true;
    for (const PlannedPicture& picture : fresh) {
      if (picture.outcome.ok() || absl::IsDataLoss(picture.outcome)) {
        settled_.insert(picture.path);
      } else {
        all_settled = false;
      }
      if (absl::IsDataLoss(picture.outcome)) bad_ = picture.outcome;
    }
    // If a picture failed in a way that may pass, the same times are checked again.
    if (all_settled) seen_ = times;
    for (PlannedPicture& picture : pictures) {
      if (settled_.contains(picture.path)) picture.outcome = absl::OkStatus();
    }
    return watch_.after_new(pictures);
  }

  int TimesDone() const { return static_cast<int>(settled_.size() / run_.Options().views.size()); }
  const absl::Status& Bad() const { return bad_; }

 private:
  const ServerWatch& watch_;
  ServerLink& server_;
  PictureRun& run_;
  RunProgress& progress_;
  std::optional<int> seen_;
  std::set<std::string> settled_;  // paths of pictures that are made or cannot be made
  absl::Status bad_;
};

}  // namespace

absl::Status WatchServer(const ServerWatch& watch, ServerLink& server, PictureRun& run,
                         RunProgress& progress, const std::stop_token& stop) {
  Watching watching(watch, server, run, progress);
  ServerOutage outage;
  while (!stop.stop_requested()) {
    absl::Status looked = watching.Look(stop);
    if (stop.stop_requested()) break;
    if (looked.ok()) {
      outage.End();
    } else if (!outage.MayRetry(looked)) {
      return looked;
    }
    if (watch.is_over(watching.TimesDone())) return watching.Bad();
    PauseForLook(stop);
  }
  return absl::CancelledError(absl::StrCat("interrupted: the products of ", watching.TimesDone(),
                                           " times are made and listed in ", run.Records().Path(),
                                           "; run the same command again to continue"));
}

}  // namespace thunderhead::runs
