// A line of JSON a second for whoever watches the window from outside: monitoring, the soak test.
#pragma once

#include <chrono>
#include <fstream>
#include <string>

#include "desktop/ui.h"

namespace thunderhead::desktop {

class StatusLog {
 public:
  // An empty path writes nothing.
  explicit StatusLog(const std::string& path);

  void Write(const Ui& ui, int view, std::chrono::steady_clock::time_point now);

 private:
  std::ofstream file_;
  const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::chrono::steady_clock::time_point last_{};
};

// Of this process, in bytes; 0 where the system does not tell.
std::int64_t ResidentBytes();

}  // namespace thunderhead::desktop
