// Reads storms' fields for the render loop on a thread of its own, so that a long read holds up
// only the session that waits for it. Each owner (a session) has at most one read, so nothing
// queues without bound.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "absl/status/statusor.h"
#include "volume/storm_store.h"

namespace thunderhead::session {

// Which fields: one time of one storm.
struct FieldsKey {
  std::string storm_id;
  int time_index = 0;

  bool operator==(const FieldsKey&) const = default;
};

struct FieldsRead {
  absl::StatusOr<std::shared_ptr<const volume::HydrometeorFields>> fields;
  double milliseconds = 0.0;
  double prepare_ms = 0.0;
};

// What is to be made of fields that were read, on the same thread; may be empty.
using PrepareFields =
    std::function<absl::Status(const std::shared_ptr<const volume::HydrometeorFields>&)>;

class FieldsReader {
 public:
  // `on_read` is called on the reading thread when a read has ended.
  FieldsReader(volume::StormStore& store, std::function<void()> on_read);
  // Waits for the read that runs.
  ~FieldsReader();
  FieldsReader(const FieldsReader&) = delete;
  FieldsReader& operator=(const FieldsReader&) = delete;

  // Asks for a read and what `prepare` makes of it; replaces the owner's earlier one if it has not
  // begun.
  void Ask(const std::string& owner, const FieldsKey& key, PrepareFields prepare = {});
  // As Ask, of what the owner may want next: begun when nobody waits, and given to nobody; what
  // counts is what the store and `prepare` keep of it. Replaces the owner's earlier one.
  void AskAhead(const std::string& owner, const FieldsKey& key, PrepareFields prepare);
  // What the owner's read gave, once.
  std::optional<FieldsRead> Take(const std::string& owner);
  // The owner wants nothing any more.
  void Forget(const std::string& owner);

 private:
  struct Asked {
    FieldsKey key;
    PrepareFields prepare;
    std::uint64_t count = 0;  // tells one asking from the next
  };

  FieldsRead Read(const Asked& work);
  // Both with `lock` held, before and after.
  void ServeFirst(std::unique_lock<std::mutex>& lock);
  void ServeAhead(std::unique_lock<std::mutex>& lock);
  void Run();

  volume::StormStore& store_;
  const std::function<void()> on_read_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool stopping_ = false;
  std::deque<std::string> waiting_;  // owners, in the order in which they asked
  std::uint64_t count_ = 0;
  std::map<std::string, Asked> asked_;
  std::map<std::string, FieldsRead> read_;
  std::map<std::string, Asked> ahead_;
  std::thread thread_;
};

}  // namespace thunderhead::session
