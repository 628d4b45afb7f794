// Reports the progress of a run of many pictures. On a terminal it shows a bar, otherwise a line
// per product. It can also write lines of JSON for machines. In a task of ecFlow it can write a
// line per product and also set ecFlow's meter.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "absl/status/status.h"
#include "runs/ecflow_reporter.h"
#include "runs/progress_bar.h"

namespace thunderhead::runs {

enum class ProgressStyle { kAuto, kLines, kJson, kEcflow, kNone };

// The time that a picture took, without waiting for other pictures.
struct PictureTimes {
  double read_ms = 0.0;   // reading the storm's file
  double draw_ms = 0.0;   // drawing, until the pixels are read back
  double write_ms = 0.0;  // encoding, hashing and writing to the disk
};

// Reports progress. Safe to call from any thread.
class RunProgress {
 public:
  RunProgress(ProgressStyle style, const std::string& label);

  // Increases the number of planned products: those to be made, and those found complete.
  void Plan(int products);
  // Drawn reports that a product was drawn in `milliseconds`. Kept reports that a product from an
  // earlier run is still valid.
  void Drawn(const std::string& path, double milliseconds,
             const std::optional<PictureTimes>& times = std::nullopt);
  void Kept(const std::string& path);
  // Reports that a product or an input failed, temporarily or permanently. The error is also
  // printed on standard error.
  void Failed(const std::string& path, const absl::Status& why);
  // Reports an ongoing activity, such as waiting for a file; `what` names it.
  void Note(const std::string& path, const std::string& what);

  int DrawnCount() const;
  int KeptCount() const;

 private:
  void Tell(const std::string& event, const std::string& path, const std::string& text,
            double milliseconds, const std::optional<PictureTimes>& times = std::nullopt);

  mutable std::mutex mutex_;
  ProgressStyle style_;
  // Null unless kAuto was given and standard error is a terminal.
  std::unique_ptr<ProgressBar> bar_;
  std::unique_ptr<EcflowReporter> ecflow_;  // null unless kEcflow was given in an ecFlow task
  int planned_ = 0;
  int drawn_ = 0;
  int kept_ = 0;
};

}  // namespace thunderhead::runs
