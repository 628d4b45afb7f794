// Keeps a store's storms those of its folders, on a thread of its own: scans them after the
// kernel's events, when a file that was written may be complete, and now and then.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "base/folder_events.h"
#include "volume/catalogue_scan.h"
#include "volume/storm_store.h"

namespace thunderhead::volume {

class LiveCatalogue {
 public:
  // Takes the storms that there are now.
  using Renew = std::function<void(const std::vector<CataloguedStorm>&)>;

  // `scan` has been made by `first`, whose storms are known.
  LiveCatalogue(std::unique_ptr<CatalogueScan> scan, CatalogueScan::Result first,
                const LiveCatalogueOptions& options, Renew renew);
  // Waits for a scan under way.
  ~LiveCatalogue();
  LiveCatalogue(const LiveCatalogue&) = delete;
  LiveCatalogue& operator=(const LiveCatalogue&) = delete;

 private:
  using Time = CatalogueScan::Time;

  void Run();
  void Scan();
  bool WatchFolders();

  const LiveCatalogueOptions options_;
  const Renew renew_;
  const std::unique_ptr<CatalogueScan> scan_;
  CatalogueScan::Result newest_;
  base::FolderEvents events_;
  std::string complaint_;  // logged last
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

}  // namespace thunderhead::volume
