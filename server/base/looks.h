// Checks something whose storage may hang, such as a file that may have changed. The checks run one
// after another on a separate thread, so that callers do not have to wait for the storage.
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

class Looks {
 public:
  static constexpr std::chrono::seconds kPatience{1};

  // Each check calls `look`, which must own everything it uses, because it may outlive this object.
  // `path` names in the log what is checked. `time` must outlive this.
  Looks(const std::string& path, std::function<void()> look,
        std::chrono::milliseconds patience = kPatience, const TimeSource& time = SteadyTime())
      : Looks(path, std::move(look), patience, std::nullopt, time) {}
  // Returns an object that also checks automatically, after each `pause`.
  static std::unique_ptr<Looks> Every(std::chrono::milliseconds pause, const std::string& path,
                                      std::function<void()> look,
                                      const TimeSource& time = SteadyTime()) {
    return std::unique_ptr<Looks>(new Looks(path, std::move(look), kPatience, pause, time));
  }
  ~Looks();
  Looks(const Looks&) = delete;
  Looks& operator=(const Looks&) = delete;

  // Waits for a check that started after this call, but not longer than the object's patience.
  // While a check hangs, it returns at once. Safe from any thread.
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
    std::uint64_t done = 0;  // the newest request for which a check has ended
    bool hangs = false;
    bool stopping = false;
  };
  Looks(const std::string& path, std::function<void()> look, std::chrono::milliseconds patience,
        std::optional<std::chrono::milliseconds> pause, const TimeSource& time);
  static void Run(const std::shared_ptr<Shared>& shared);

  const std::chrono::milliseconds patience_;
  const std::shared_ptr<Shared> shared_;
  LooseThread thread_;
};

}  // namespace thunderhead::base
