// Scans the same paths again and again for storms and tells complete files from those that are
// still being written. Describes a file only when it has changed. Told the time; knows no threads.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "base/patient_calls.h"
#include "base/time_source.h"
#include "storm_files/storm_format.h"
#include "storm_store/storm_catalogue.h"

namespace thunderhead::storm_store {

class CatalogueScan {
 public:
  using Time = std::chrono::steady_clock::time_point;

  struct Options {
    std::vector<std::string> paths;
    storm_files::StormFormats formats;
    LinkPolicy links = {};
    std::chrono::milliseconds settle{};
    // A complete file that cannot be read is tried again after this time, although it has not
    // changed: its writer may have released a lock.
    std::chrono::milliseconds retry{};
    // Called before each file is opened; may wait.
    std::function<void()> before_file = [] {};
    // How a path is looked at before it is searched; it may hang.
    std::function<void(const std::string& path)> look_at = LookAtFolder;
    // How long that may take; then the path's storage hangs, and its storms stay as they were.
    std::chrono::milliseconds patience = std::chrono::seconds(10);
    // The time that `patience` is measured by; it must outlive the scan.
    const base::TimeSource* time = &base::SteadyTime();
  };

  struct Result {
    std::vector<CataloguedStorm> storms;
    std::vector<std::string> folders;   // that were listed
    std::optional<Time> look_again_at;  // when a file that was written until now may be complete
    bool changed = true;                // since the last Scan
  };

  explicit CatalogueScan(Options options)
      : options_(std::move(options)), calls_(options_.patience, *options_.time) {}

  // Opens it and reads its first entry, or the file's first byte.
  static void LookAtFolder(const std::string& path);

  // Files of the first scan are complete if they are older than the settling time; what comes
  // later must have been seen unchanged for so long. A file that grows keeps the description that
  // it had, until it is complete again, and so does one whose place another took in one step. An
  // error, such as a folder that cannot be listed, says nothing about which storms there are.
  absl::StatusOr<Result> Scan(Time now);

 private:
  // Identity of one state of a file.
  struct Stamp {
    std::uint64_t file = 0;  // inode and device
    std::uint64_t size_bytes = 0;
    std::int64_t changed_ns = 0;

    bool operator==(const Stamp&) const = default;
  };

  struct Known {
    Stamp stamp;
    Time unchanged_since;
    bool settled = false;
    std::optional<Time> tried_at;                       // with this stamp
    std::optional<storm_files::StormFile> description;  // perhaps of an earlier, shorter state
    bool replaces = false;                              // the file that the description is of
    std::string complaint;                              // logged last
    std::uint64_t scan = 0;                             // that saw it last
  };

  // False while the path's storage hangs.
  bool Answers(const std::string& path);
  static std::optional<Stamp> StampOf(const std::string& path);
  absl::StatusOr<storm_files::StormFile> Describe(const std::string& path, Time now);
  void Look(const std::string& path, const Stamp& stamp, Time now, Known& known);
  void Open(const std::string& path, Time now, Known& known);
  void Lose(Known& known);  // its description
  void LookAgainAt(Time time);

  const Options options_;
  base::PatientCalls calls_;
  FoundByPath found_;
  std::set<std::string> hanging_;  // paths
  std::map<std::string, Known> known_;
  std::set<std::string> unlisted_;  // folders that were complained of
  std::uint64_t scans_ = 0;
  std::uint64_t versions_ = 0;
  bool changed_ = true;
  std::optional<Time> look_again_at_;
};

}  // namespace thunderhead::storm_store
