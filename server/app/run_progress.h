// How a run of many pictures tells of itself: a bar on a terminal, otherwise a line a product, or
// lines of JSON for machines, or a line a product and ecFlow's meter in a task of ecFlow.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "absl/status/status.h"
#include "app/ecflow_reporter.h"
#include "app/progress_bar.h"

namespace thunderhead::app {

enum class ProgressStyle { kAuto, kLines, kJson, kEcflow, kNone };

// The time that a picture took, without waiting for others.
struct PictureTimes {
  double read_ms = 0.0;   // the storm's file
  double draw_ms = 0.0;   // until its pixels are read back
  double write_ms = 0.0;  // encoding, hashing and bringing it to the disk
};

// Safe from any thread.
class RunProgress {
 public:
  RunProgress(ProgressStyle style, const std::string& label);

  // Some more products are to be made, or were found made.
  void Plan(int products);
  // A product is there: `milliseconds` after its drawing began, or unchanged since an earlier run.
  void Drawn(const std::string& path, double milliseconds,
             const std::optional<PictureTimes>& times = std::nullopt);
  void Kept(const std::string& path);
  // A product or input that does not come, now or ever; also on standard error.
  void Failed(const std::string& path, const absl::Status& why);
  // Something that goes on, such as a file that is waited for; `what` names it.
  void Note(const std::string& path, const std::string& what);

  int DrawnCount() const;
  int KeptCount() const;

 private:
  void Tell(const std::string& event, const std::string& path, const std::string& text,
            double milliseconds, const std::optional<PictureTimes>& times = std::nullopt);

  mutable std::mutex mutex_;
  ProgressStyle style_;
  std::unique_ptr<ProgressBar> bar_;        // null: no terminal
  std::unique_ptr<EcflowReporter> ecflow_;  // null: no task of ecFlow
  int planned_ = 0;
  int drawn_ = 0;
  int kept_ = 0;
};

}  // namespace thunderhead::app
