// Writes one line of JSON a second about the client's state, for monitoring and the soak test. A
// file that reaches kMaxBytes is renamed to FILE.1, which replaces an older FILE.1, and a new file
// begins.
#pragma once

#include <chrono>
#include <cstdint>
#include <fstream>
#include <string>

#include "absl/status/status.h"
#include "desktop/input_tally.h"
#include "desktop/ui.h"

namespace thunderhead::desktop {

// A writer of lines to a file of limited size.
class RotatedFile {
 public:
  // Truncates the file. With an empty path the object writes nothing.
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

  // Returns INVALID_ARGUMENT with the path and the reason if the file is not writable.
  static absl::Status CheckWritable(const std::string& path);
  // Opens the log. With an empty path it writes nothing. Write() does nothing until `interval` has
  // passed since the last line.
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

// Returns this process's resident memory in bytes; 0 if the system does not report it.
std::int64_t ResidentBytes();

}  // namespace thunderhead::desktop
