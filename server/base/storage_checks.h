// Runs checks of something on a storage that may hang, for example of whether a file has changed.
// The checks run one after another on a separate thread, so that callers do not have to wait for
// the storage.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "base/loose_thread.h"
#include "base/time_source.h"

namespace thunderhead::base {

class StorageChecks {
 public:
  static constexpr std::chrono::seconds kPatience{1};

  // Creates an object whose checks call `look`. `look` must own everything it uses, because a
  // hanging check can outlive the object. In the log, `path` names the checked file or folder.
  // `time` must outlive this object.
  StorageChecks(const std::string& path, std::function<void()> look,
                std::chrono::milliseconds patience = kPatience,
                const TimeSource& time = SteadyTime())
      : StorageChecks(path, std::move(look), patience, std::nullopt, time) {}
  // Returns an object that also checks automatically, after each `pause`.
  static std::unique_ptr<StorageChecks> Every(std::chrono::milliseconds pause,
                                              const std::string& path, std::function<void()> look,
                                              const TimeSource& time = SteadyTime()) {
    return std::unique_ptr<StorageChecks>(
        new StorageChecks(path, std::move(look), kPatience, pause, time));
  }
  ~StorageChecks();
  StorageChecks(const StorageChecks&) = delete;
  StorageChecks& operator=(const StorageChecks&) = delete;

  // Requests a check and waits until it has ended, but no longer than the object's patience. While
  // an earlier check hangs, the function returns at once. Safe from any thread.
  void LookAgain();

 private:
  struct Shared {
    const std::function<void()> look;
    const std::string path;
    const std::optional<std::chrono::milliseconds> pause;
    const TimeSource& time;
    std::mutex mutex;
    std::condition_variable changed;
    std::uint64_t asked = 0;
    std::uint64_t done = 0;  // number of the newest request for which a check has ended
    bool hangs = false;
    bool stopping = false;
  };
  StorageChecks(const std::string& path, std::function<void()> look,
                std::chrono::milliseconds patience, std::optional<std::chrono::milliseconds> pause,
                const TimeSource& time);
  static void Run(const std::shared_ptr<Shared>& shared);

  const std::chrono::milliseconds patience_;
  const std::shared_ptr<Shared> shared_;
  LooseThread thread_;
};

}  // namespace thunderhead::base
