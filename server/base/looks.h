// Looks at something whose storage may hang, such as a file that may have changed, for those who
// must not wait for it: the looks are taken on a thread of their own, one after another.
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

  // `look` must own all that it uses, as it may outlive this. `path` is what it looks at, for the
  // log. `time` must outlive this.
  Looks(const std::string& path, std::function<void()> look,
        std::chrono::milliseconds patience = kPatience, const TimeSource& time = SteadyTime())
      : Looks(path, std::move(look), patience, std::nullopt, time) {}
  // Looks by itself, too, after each such pause.
  static std::unique_ptr<Looks> Every(std::chrono::milliseconds pause, const std::string& path,
                                      std::function<void()> look,
                                      const TimeSource& time = SteadyTime()) {
    return std::unique_ptr<Looks>(new Looks(path, std::move(look), kPatience, pause, time));
  }
  ~Looks();
  Looks(const Looks&) = delete;
  Looks& operator=(const Looks&) = delete;

  // Returns after a look that began after this call did; or once its patience is over, and at once
  // until the look that hangs has ended. From any thread.
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
    std::uint64_t done = 0;  // the newest request for which a look has ended
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
