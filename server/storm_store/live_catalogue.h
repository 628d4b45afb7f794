// Keeps a store's storms in step with its folders, on a separate thread. It scans the folders at
// the start, after the kernel reports an event, when a file that was being written may be complete,
// and at regular intervals.
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
  // A function that takes the result of each scan, with all storms that exist now.
  using Renew = std::function<void(const CatalogueScan::Result&)>;

  // `renew` must own everything it uses. `time` must outlive the thread.
  LiveCatalogue(std::unique_ptr<CatalogueScan> scan, const LiveCatalogueOptions& options,
                const base::TimeSource& time, Renew renew);
  // Waits for a scan in progress, unless it hangs.
  ~LiveCatalogue();
  LiveCatalogue(const LiveCatalogue&) = delete;
  LiveCatalogue& operator=(const LiveCatalogue&) = delete;

 private:
  using Time = CatalogueScan::Time;

  // The thread's state. The thread may outlive the LiveCatalogue.
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
    std::string complaint = {};  // the message that was logged last
    std::atomic<bool> stopping = false;
  };

  const std::shared_ptr<Running> running_;
  base::LooseThread thread_;
};

}  // namespace thunderhead::storm_store
