#include "storm_store/live_catalogue.h"

#include <algorithm>
#include <utility>

#include "spdlog/spdlog.h"

namespace thunderhead::storm_store {
namespace {

using std::chrono::milliseconds;

// Events come in bursts, and a scan examines every file, so there is a pause between scans.
constexpr milliseconds kShortestPause{300};

}  // namespace

LiveCatalogue::LiveCatalogue(std::unique_ptr<CatalogueScan> scan,
                             const LiveCatalogueOptions& options, const base::TimeSource& time,
                             Renew renew)
    : running_(new Running{
          .options = options, .time = time, .renew = std::move(renew), .scan = std::move(scan)}),
      thread_(
          "the search for storms", [running = running_] { running->Run(); }, time) {}

LiveCatalogue::~LiveCatalogue() {
  running_->stopping = true;
  running_->scan->Stop();
  running_->events.Wake();
}

void LiveCatalogue::Running::Run() {
  Scan();
  // The kernel reports no event for changes between the first scan and the start of watching, so
  // another scan follows.
  bool again = WatchFolders();
  while (!stopping) {
    const Time pause_ends = time.Now() + kShortestPause;
    Time next = time.Now() + options.rescan;
    if (newest.look_again_at.has_value()) next = std::min(next, *newest.look_again_at);
    const bool at_once = newest.is_unfinished;
    if (!again && !at_once) WaitForEventUntil(next);
    while (!stopping && !at_once && time.Now() < pause_ends) WaitForEventUntil(pause_ends);
    if (stopping) return;
    Scan();
    again = WatchFolders();
  }
}

void LiveCatalogue::Running::WaitForEventUntil(Time deadline) {
  while (!stopping && time.Now() < deadline && !events.WaitUntil(time.LookAgainAt(deadline))) {
  }
}

void LiveCatalogue::Running::Scan() {
  absl::StatusOr<CatalogueScan::Result> result = scan->Scan(time.Now());
  if (stopping) return;
  if (!result.ok()) {
    std::string why(result.status().message());
    if (why != complaint) spdlog::warn("the storms stay as they were: {}", why);
    complaint = std::move(why);
    newest.look_again_at.reset();
    newest.is_unfinished = false;
    return;
  }
  if (!complaint.empty()) spdlog::info("the folders of storms can be listed again");
  complaint.clear();
  newest = *std::move(result);
  // The store is also renewed without a change, because a deleted time may no longer be in use.
  renew(newest);
}

// Starts to watch the folders that the scan listed. Returns whether one of them was not watched
// during the scan.
bool LiveCatalogue::Running::WatchFolders() {
  bool any = false;
  for (const std::string& folder : newest.folders) any = events.Watch(folder) || any;
  return any;
}

}  // namespace thunderhead::storm_store
