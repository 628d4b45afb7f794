#include "volume/live_catalogue.h"

#include <algorithm>
#include <utility>

#include "spdlog/spdlog.h"

namespace thunderhead::volume {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

// Events come in bursts, and a scan looks at every file.
constexpr milliseconds kShortestPause{300};

}  // namespace

LiveCatalogue::LiveCatalogue(std::unique_ptr<CatalogueScan> scan, CatalogueScan::Result first,
                             const LiveCatalogueOptions& options, Renew renew)
    : running_(new Running{.options = options,
                           .renew = std::move(renew),
                           .scan = std::move(scan),
                           .newest = std::move(first)}),
      thread_("the search for storms", [running = running_] { running->Run(); }) {}

LiveCatalogue::~LiveCatalogue() {
  running_->stopping = true;
  running_->events.Wake();
}

void LiveCatalogue::Running::Run() {
  // Changes between the first scan and the watch have no event.
  bool again = WatchFolders();
  while (!stopping) {
    const Time pause_ends = steady_clock::now() + kShortestPause;
    Time next = steady_clock::now() + options.rescan;
    if (newest.look_again_at.has_value()) next = std::min(next, *newest.look_again_at);
    if (!again) events.WaitUntil(next);
    while (!stopping && steady_clock::now() < pause_ends) events.WaitUntil(pause_ends);
    if (stopping) return;
    Scan();
    again = WatchFolders();
  }
}

void LiveCatalogue::Running::Scan() {
  absl::StatusOr<CatalogueScan::Result> result = scan->Scan(steady_clock::now());
  if (!result.ok()) {
    std::string why(result.status().message());
    if (why != complaint) spdlog::warn("the storms stay as they were: {}", why);
    complaint = std::move(why);
    newest.look_again_at.reset();
    return;
  }
  if (!complaint.empty()) spdlog::info("the folders of storms can be listed again");
  complaint.clear();
  newest = *std::move(result);
  // Also without a change: somebody may have left what was deleted.
  renew(newest.storms);
}

// True if there is a folder that was not watched during the scan.
bool LiveCatalogue::Running::WatchFolders() {
  bool any = false;
  for (const std::string& folder : newest.folders) any = events.Watch(folder) || any;
  return any;
}

}  // namespace thunderhead::volume
