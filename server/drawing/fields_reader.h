// Reads storms' fields for the render loop on a separate thread, so that a long read delays only
// the session that needs the fields. Each owner (a session) has at most one pending read, which
// bounds the queue.
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
#include "storm_store/storm_store.h"

namespace thunderhead::drawing {

// Identifies fields: one time of one storm.
struct FieldsKey {
  std::string storm_id;
  int time_index = 0;
  // storm_store::StormTime::version at the time of the request.
  std::uint64_t version = 0;

  bool operator==(const FieldsKey&) const = default;
};

struct FieldsRead {
  absl::StatusOr<std::shared_ptr<const volume::HydrometeorFields>> fields;
  double milliseconds = 0.0;
  double prepare_ms = 0.0;
};

// Prepares fields after they were read, on the same thread. It may be empty (no preparation).
using PrepareFields =
    std::function<absl::Status(const std::shared_ptr<const volume::HydrometeorFields>&)>;

class FieldsReader {
 public:
  // `on_read` is called on the reading thread after each read.
  FieldsReader(storm_store::StormStore& store, std::function<void()> on_read);
  // Waits for the running read.
  ~FieldsReader();
  FieldsReader(const FieldsReader&) = delete;
  FieldsReader& operator=(const FieldsReader&) = delete;

  // Requests a read followed by `prepare`. It replaces an earlier request of the owner.
  void Ask(const std::string& owner, const FieldsKey& key, PrepareFields prepare = {});
  // Reads fields that the owner may request next, when no other request waits. The read has no
  // result: it only fills the caches of the store and of `prepare`. It replaces an earlier prefetch
  // of the owner.
  void AskAhead(const std::string& owner, const FieldsKey& key, PrepareFields prepare);
  // Takes the result of the owner's read, if there is one.
  std::optional<FieldsRead> Take(const std::string& owner);
  // Drops the owner's requests and result.
  void Forget(const std::string& owner);

 private:
  struct Asked {
    FieldsKey key;
    PrepareFields prepare;
    std::uint64_t count = 0;  // number of the request, by which it is identified
  };

  FieldsRead Read(const Asked& work);
  // `lock` is held on entry and on return.
  void ServeFirst(std::unique_lock<std::mutex>& lock);
  void ServeAhead(std::unique_lock<std::mutex>& lock);
  void Run();

  storm_store::StormStore& store_;
  const std::function<void()> on_read_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool stopping_ = false;
  std::deque<std::string> waiting_;  // owners, in order of their requests
  std::uint64_t count_ = 0;
  std::map<std::string, Asked> asked_;
  std::map<std::string, FieldsRead> read_;
  std::map<std::string, Asked> ahead_;
  std::thread thread_;
};

}  // namespace thunderhead::drawing
