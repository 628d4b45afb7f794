// The listeners for changes of render jobs.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace thunderhead::jobs {

// A listener that is notified when a job has changed or was removed, or when the server stops.
class JobWatcher {
 public:
  virtual ~JobWatcher() = default;
  // Called on any thread. It must not block.
  virtual void OnJobChanged() = 0;
};

// The watchers of each job, by the job's id. A watcher ends by being destroyed. Not safe for
// concurrent calls.
class JobWatchers {
 public:
  // Adds a watcher of the job. Drops those of its watchers that were destroyed.
  void Add(const std::string& id, std::weak_ptr<JobWatcher> watcher);

  // Returns the living watchers of these jobs. Drops those that were destroyed. The caller notifies
  // the watchers after it has released its lock.
  std::vector<std::shared_ptr<JobWatcher>> Of(const std::vector<std::string>& ids);

  // Returns the ids of the jobs that have watchers, once for each watcher.
  std::vector<std::string> Watched() const;

  // Drops the job's watchers.
  void Forget(const std::string& id) { watchers_.erase(id); }

  // Returns the number of watchers, including destroyed ones that were not dropped yet.
  std::size_t Size() const { return watchers_.size(); }

 private:
  void DropGone(const std::string& id);

  std::multimap<std::string, std::weak_ptr<JobWatcher>> watchers_;
};

}  // namespace thunderhead::jobs
