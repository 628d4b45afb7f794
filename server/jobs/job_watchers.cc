#include "jobs/job_watchers.h"

#include <iterator>
#include <utility>

namespace thunderhead::jobs {

void JobWatchers::Add(const std::string& id, std::weak_ptr<JobWatcher> watcher) {
  DropGone(id);
  watchers_.emplace(id, std::move(watcher));
}

std::vector<std::shared_ptr<JobWatcher>> JobWatchers::Of(const std::vector<std::string>& ids) {
  std::vector<std::shared_ptr<JobWatcher>> living;
  for (const std::string& id : ids) {
    DropGone(id);
    const auto [begin, end] = watchers_.equal_range(id);
    for (auto watcher = begin; watcher != end; ++watcher) {
      if (auto here = watcher->second.lock(); here != nullptr) living.push_back(std::move(here));
    }
  }
  return living;
}

std::vector<std::string> JobWatchers::Watched() const {
  std::vector<std::string> ids;
  for (const auto& [id, watcher] : watchers_) ids.push_back(id);
  return ids;
}

void JobWatchers::DropGone(const std::string& id) {
  const auto [begin, end] = watchers_.equal_range(id);
  for (auto watcher = begin; watcher != end;) {
    watcher = watcher->second.expired() ? watchers_.erase(watcher) : std::next(watcher);
  }
}

}  // namespace thunderhead::jobs
