#include "storm_store/left_out_log.h"

#include <utility>

#include "spdlog/spdlog.h"

namespace thunderhead::storm_store {

void LeftOutLog::BeginMinute(Time now) {
  if (minute_ != Time::min() && now - minute_ < std::chrono::minutes(1)) return;
  minute_ = now;
  lines_ = 0;
  is_summarized_ = false;
}

void LeftOutLog::Add(const std::string& reason, bool is_warning, Time now) {
  BeginMinute(now);
  if (lines_ >= kMostLines) {
    ++counted_;
    last_ = reason;
    return;
  }
  ++lines_;
  spdlog::log(is_warning ? spdlog::level::warn : spdlog::level::info, "left out: {}", reason);
}

void LeftOutLog::Summarize(Time now) {
  BeginMinute(now);
  if (counted_ == 0 || std::exchange(is_summarized_, true)) return;
  spdlog::warn("left out: {} more files, of which the last is {}", std::exchange(counted_, 0),
               last_);
}

}  // namespace thunderhead::storm_store
