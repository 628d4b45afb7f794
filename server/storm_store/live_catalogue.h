// Keeps a store's storms those of its folders, on a thread of its own: scans them at once, after
// the kernel's events, when a file that was written may be complete, and now and then.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/folder_events.h"
#include "base/loose_thread.h"
#include "storm_store/catalogue_scan.h"
#include "storm_store/storm_store.h"

namespace thunderhead::storm_store {

class LiveCatalogue {
 public:
  // Takes the result of each scan, whose storms are all that there are now.
  using Renew = std::function<void(const CatalogueScan::Result&)>;

  // `renew` must own what it uses. `time` must outlive the thread.
  LiveCatalogue(std::unique_ptr<CatalogueScan> scan, const LiveCatalogueOptions& options,
                const base::TimeSource& time, Renew renew);
  // Waits for a scan under way, unless it hangs.
  ~LiveCatalogue();
  LiveCatalogue(const LiveCatalogue&) = delete;
  LiveCatalogue& operator=(const LiveCatalogue&) = delete;

 private:
  using Time = CatalogueScan::Time;

  // Belongs to the thread, which may outlive this.
  struct Running {
    void Run();
    void Scan();
    bool WatchFolders();
    void WaitForEventUntil(Time deadline);

    const LiveCatalogueOptions options;
    const base::TimeSource& time;
    const Renew renew;
    const std::unique_ptr<CatalogueScan> scan;
    CatalogueScan::Result newest = {};
    base::FolderEvents events = {};
    std::string complaint = {};  // logged last
    std::atomic<bool> stopping = false;
  };

  const std::shared_ptr<Running> running_;
  base::LooseThread thread_;
};

}  // namespace thunderhead::storm_store
