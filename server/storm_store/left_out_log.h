// Logs which files a search leaves out, and why. A hostile folder may have any number of them, so
// the lines of a minute are limited, and the others are counted.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace thunderhead::storm_store {

class LeftOutLog {
 public:
  using Time = std::chrono::steady_clock::time_point;

  // Logs "left out: REASON", as a warning or as information, or counts it.
  void Add(const std::string& reason, bool is_warning, Time now);

  // Logs how many reasons were only counted, at most once a minute.
  void Summarize(Time now);

 private:
  void BeginMinute(Time now);

  static constexpr int kMostLines = 20;  // a minute

  Time minute_ = Time::min();  // when the present minute began
  int lines_ = 0;              // number of lines logged in the present minute
  bool is_summarized_ = false;
  std::uint64_t counted_ = 0;
  std::string last_;  // the reason that was counted last
};

}  // namespace thunderhead::storm_store
