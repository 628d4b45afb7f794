// A line of JSON a second for whoever watches the window from outside: monitoring, the soak test.
// At kMaxBytes the file becomes FILE.1, in place of an older one, and another begins.
#pragma once

#include <chrono>
#include <cstdint>
#include <fstream>
#include <string>

#include "absl/status/status.h"
#include "desktop/input_tally.h"
#include "desktop/ui.h"

namespace thunderhead::desktop {

// Lines in a file of limited size.
class RotatedFile {
 public:
  // An empty path writes nothing. Begins anew what is there.
  RotatedFile(std::string path, std::int64_t max_bytes);

  bool is_open() const { return file_.is_open(); }
  void Write(const std::string& line);

 private:
  const std::string path_;
  const std::int64_t max_bytes_;
  std::ofstream file_;
  std::int64_t bytes_ = 0;
};

class StatusLog {
 public:
  static constexpr std::int64_t kMaxBytes = 1 << 20;
  static constexpr std::chrono::milliseconds kInterval{1000};

  // INVALID_ARGUMENT names the path and why it cannot be written to.
  static absl::Status CheckWritable(const std::string& path);
  // An empty path writes nothing. Calls of Write() within `interval` of the last line write
  // nothing.
  StatusLog(const std::string& path, std::chrono::milliseconds interval)
      : file_(path, kMaxBytes), interval_(interval) {}

  void Write(const Ui& ui, int view, const InputTally& input,
             std::chrono::steady_clock::time_point now);

 private:
  RotatedFile file_;
  const std::chrono::milliseconds interval_;
  const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::chrono::steady_clock::time_point last_{};
};

// Of this process, in bytes; 0 where the system does not tell.
std::int64_t ResidentBytes();

}  // namespace thunderhead::desktop
