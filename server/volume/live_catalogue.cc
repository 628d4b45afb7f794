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
    : options_(options),
      renew_(std::move(renew)),
      scan_(std::move(scan)),
      newest_(std::move(first)),
      thread_([this] { Run(); }) {}

LiveCatalogue::~LiveCatalogue() {
  stopping_ = true;
  events_.Wake();
  thread_.join();
}

void LiveCatalogue::Run() {
  // What happened between the first scan and the watch has no event.
  bool again = WatchFolders();
  while (!stopping_) {
    const Time pause_ends = steady_clock::now() + kShortestPause;
    Time next = steady_clock::now() + options_.rescan;
    if (newest_.look_again_at.has_value()) next = std::min(next, *newest_.look_again_at);
    if (!again) events_.WaitUntil(next);
    while (!stopping_ && steady_clock::now() < pause_ends) events_.WaitUntil(pause_ends);
    if (stopping_) return;
    Scan();
    again = WatchFolders();
  }
}

void LiveCatalogue::Scan() {
  absl::StatusOr<CatalogueScan::Result> result = scan_->Scan(steady_clock::now());
  if (!result.ok()) {
    const std::string complaint(result.status().message());
    if (complaint != complaint_) spdlog::warn("the storms stay as they were: {}", complaint);
    complaint_ = complaint;
    newest_.look_again_at.reset();
    return;
  }
  if (!complaint_.empty()) spdlog::info("the folders of storms can be listed again");
  complaint_.clear();
  newest_ = *std::move(result);
  // Also without a change: somebody may have left what was deleted.
  renew_(newest_.storms);
}

// True if there is a folder that was not watched during the scan.
bool LiveCatalogue::WatchFolders() {
  bool any = false;
  for (const std::string& folder : newest_.folders) any = events_.Watch(folder) || any;
  return any;
}

}  // namespace thunderhead::volume
