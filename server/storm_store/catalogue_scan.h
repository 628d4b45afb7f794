// Scans the same paths repeatedly for storms, and distinguishes complete files from those that are
// still being written. It describes a file again only when the file has changed. The caller passes
// the current time. The class starts threads only for calls with a timeout.
#pragma once

#include <atomic>
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
    // The time after which an unchanged file that could not be read is tried again, because its
    // writer may have released a lock meanwhile.
    std::chrono::milliseconds retry{};
    // A function that is called before each file, or each batch of small files, is opened. It may
    // wait.
    std::function<void()> before_file = [] {};
    // A function that is called for each path before it is searched, to find out whether the path's
    // storage responds. It may hang.
    std::function<void(const std::string& path)> look_at = LookAtFolder;
    // The timeout of `look_at`. After it the path's storage counts as hanging, and the path's
    // storms stay unchanged.
    std::chrono::milliseconds patience = std::chrono::seconds(10);
    // The time source for `patience`. It must outlive the scan.
    const base::TimeSource* time = &base::SteadyTime();
  };

  struct Result {
    std::vector<CataloguedStorm> storms;
    std::vector<std::string> folders;   // folders that were listed
    std::optional<Time> look_again_at;  // when to scan again, because a file that is being written
                                        // may then be complete; nothing if no file is being written
    bool changed = true;                // whether anything changed since the last Scan
  };

  explicit CatalogueScan(Options options)
      : options_(std::move(options)), calls_(options_.patience, *options_.time) {}

  // Opens a folder and reads the attributes of its first entry.
  static void LookAtFolder(const std::string& path);

  // Finds the storms under the paths. In the first scan, a file counts as complete if its last
  // change is older than Options::settle. A file that appears or changes later counts as complete
  // when no scan has seen a change for that time. While a file grows, its old description stays
  // valid. The same is true after another file replaced it in one step (by a rename). If Scan
  // returns an error, such as a folder that cannot be listed, the previous storms must be kept.
  absl::StatusOr<Result> Scan(Time now);

  // Ends the scan in progress after the file that it reads, with CANCELLED, and every later scan
  // likewise. Any thread may call it.
  void Stop() { stopping_ = true; }

 private:
  // A file's identity, size and change time (its stamp). The stamp differs after each change of the
  // file.
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
    std::optional<Time> tried_at;                       // when the file was last opened in its
                                                        // present state
    std::optional<storm_files::StormFile> description;  // may describe an earlier, shorter state of
                                                        // the file
    bool replaces = false;   // true if `description` is of another file, which this file replaced
    std::string complaint;   // the message that was logged last
    std::uint64_t scan = 0;  // number of the scan that last saw the file
  };

  // One time that is spread over several files.
  struct KnownTogether {
    std::vector<std::uint64_t> versions;  // StormFile::version of each file
    absl::StatusOr<storm_files::StormFile> description = absl::CancelledError();
    std::uint64_t scan = 0;  // number of the scan that last saw it
  };

  // Returns false while the path's storage hangs.
  bool Answers(const std::string& path);
  static std::optional<Stamp> StampOf(const std::string& path);
  std::vector<absl::StatusOr<storm_files::StormFile>> Describe(
      const std::vector<std::string>& paths, Time now);
  absl::StatusOr<storm_files::StormFile> DescribeTogether(const std::vector<std::string>& paths);
  // Returns whether the file must be opened now.
  bool Look(const Stamp& stamp, Time now, Known& known);
  bool MustOpen(Time now, const Known& known) const;
  // Takes the description of a file that was opened.
  void Take(const std::string& path, Time now, absl::StatusOr<storm_files::StormFile> file,
            Known& known);
  void Lose(Known& known);  // removes the description
  void LookAgainAt(Time time);

  const Options options_;
  std::atomic<bool> stopping_ = false;
  base::PatientCalls calls_;
  FoundByPath found_;
  std::set<std::string> hanging_;  // paths whose storage hangs
  std::map<std::string, Known> known_;
  // The times that are spread over several files, by the paths of these files.
  std::map<std::vector<std::string>, KnownTogether> together_;
  std::set<std::string> unlisted_;  // folders for which a warning was logged
  std::uint64_t scans_ = 0;
  std::uint64_t versions_ = 0;
  bool changed_ = true;
  std::optional<Time> look_again_at_;
};

}  // namespace thunderhead::storm_store
