#include "runs/run_progress.h"

#include <unistd.h>

#include <iostream>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/utf8.h"
#include "nlohmann/json.hpp"
#include "runs/tell_user.h"

namespace thunderhead::runs {

RunProgress::RunProgress(ProgressStyle style, const std::string& label) : style_(style) {
  if (style == ProgressStyle::kEcflow) {
    style_ = ProgressStyle::kLines;
    if (EcflowReporter::InTask()) ecflow_ = std::make_unique<EcflowReporter>();
  }
  if (style != ProgressStyle::kAuto) return;
  style_ = isatty(STDERR_FILENO) == 1 ? ProgressStyle::kNone : ProgressStyle::kLines;
  if (style_ == ProgressStyle::kNone) bar_ = std::make_unique<ProgressBar>(label);
}

void RunProgress::Plan(int products) {
  const std::lock_guard lock(mutex_);
  planned_ += products;
}

void RunProgress::Drawn(const std::string& path, double milliseconds,
                        const std::optional<PictureTimes>& times) {
  const std::lock_guard lock(mutex_);
  ++drawn_;
  Tell("drawn", path, absl::StrFormat("%s (%.0f ms)", path, milliseconds), milliseconds, times);
}

void RunProgress::Kept(const std::string& path) {
  const std::lock_guard lock(mutex_);
  ++kept_;
  Tell("kept", path, absl::StrCat(path, " (as before)"), 0.0);
}

void RunProgress::Failed(const std::string& path, const absl::Status& why) {
  const std::lock_guard lock(mutex_);
  TellUser({why.message().data(), why.message().size()});
  if (style_ == ProgressStyle::kJson) Tell("failed", path, std::string(why.message()), 0.0);
}

void RunProgress::Note(const std::string& path, const std::string& what) {
  const std::lock_guard lock(mutex_);
  if (bar_ != nullptr) return bar_->Note(what);
  if (style_ == ProgressStyle::kJson) Tell("waiting", path, what, 0.0);
  if (style_ == ProgressStyle::kLines) TellUser(what);
}

int RunProgress::DrawnCount() const {
  const std::lock_guard lock(mutex_);
  return drawn_;
}

int RunProgress::KeptCount() const {
  const std::lock_guard lock(mutex_);
  return kept_;
}

// Writes a line and flushes it, because its reader may be waiting for it.
void RunProgress::Tell(const std::string& event, const std::string& path, const std::string& text,
                       double milliseconds, const std::optional<PictureTimes>& times) {
  const int done = drawn_ + kept_;
  if (ecflow_ != nullptr) ecflow_->Tell(done, planned_, path);
  if (bar_ != nullptr) {
    bar_->Set(planned_ == 0 ? 0.0 : static_cast<double>(done) / planned_);
    bar_->Note(absl::StrCat(done, " of ", planned_));
  } else if (style_ == ProgressStyle::kLines) {
    std::cout << base::Printable(text, {.max_bytes = base::kMaxLineBytes}) << std::endl;
  } else if (style_ == ProgressStyle::kJson) {
    nlohmann::ordered_json json = {{"event", event}, {"file", path}};
    if (event == "drawn") json["milliseconds"] = milliseconds;
    if (times.has_value()) {
      json["read_ms"] = times->read_ms;
      json["draw_ms"] = times->draw_ms;
      json["write_ms"] = times->write_ms;
    }
    if (event != "drawn" && event != "kept") json["message"] = text;
    json["done"] = done;
    json["planned"] = planned_;
    std::cout << json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) << std::endl;
  }
}

}  // namespace thunderhead::runs
