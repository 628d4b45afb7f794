// Scans the same paths repeatedly for storms, and distinguishes complete files from those that are
// still being written. It describes a file again only when the file has changed. The caller passes
// the current time. The class starts threads only for calls with a timeout.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "base/time_source.h"
#include "base/timed_calls.h"
#include "storm_files/storm_format.h"
#include "storm_store/fair_folders.h"
#include "storm_store/left_out_log.h"
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
    // The time after which a scan describes no other file, unless it has described none so far. It
    // is longer if the files are listed slowly. The other files are described by the next scans.
    std::chrono::milliseconds turn = std::chrono::seconds(2);
    // The longest time for the first description of a file or of a batch. A file that needs longer
    // is described again later, alone and with storm_files::kLongestDescription.
    std::chrono::milliseconds trial = std::chrono::seconds(2);
    // Maximum number of files and folders below one path.
    std::size_t most_entries = 200'000;
    // The time source for durations. It must outlive the scan.
    const base::TimeSource* time = &base::SteadyTime();
  };

  struct Result {
    std::vector<CataloguedStorm> storms;
    std::vector<std::string> folders;   // folders that were listed
    std::optional<Time> look_again_at;  // when to scan again, because a file that is being written
                                        // may then be complete; nothing if no file is being written
    bool changed = true;                // whether anything changed since the last Scan
    // True if files wait for the next scan, which must follow at once.
    bool is_unfinished = false;
    // True if some of these files were not tried yet, or only in a batch, so that storms may still
    // be missing.
    bool has_untried = false;
  };

  explicit CatalogueScan(Options options)
      : options_(std::move(options)), calls_(options_.patience, *options_.time) {}

  // Opens a folder and reads the attributes of its first entry.
  static void LookAtFolder(const std::string& path);

  // Finds the storms under the paths. In the first scan, a file counts as complete if its last
  // change is older than Options::settle. A file that appears or changes later counts as complete
  // when no scan has seen a change for that time. While a file grows, its old description stays
  // valid. The same is true after another file replaced it in one step (by a rename).
  //
  // A scan ends when its time (Options::turn) is used up, even if files still wait to be described.
  // Folders share the time of the scans fairly, so that slow files delay only their own folder. If
  // Scan returns an error, such as a folder that cannot be listed, the previous storms must be
  // kept.
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

  // How the next attempt describes a file. The first attempt describes it in a batch with other
  // files (kBatch). If a batch takes too long (Options::trial), each of its files is described
  // alone with the same timeout (kAlone). A file that alone takes too long is described with the
  // longest timeout, storm_files::kLongestDescription (kPatient).
  enum class Trial { kBatch, kAlone, kPatient };

  struct Known {
    Stamp stamp;
    Time unchanged_since;
    bool settled = false;
    std::optional<Time> tried_at;                       // when the file was last opened in its
                                                        // present state
    int tries = 0;                                      // number of attempts without success
    Trial trial = Trial::kBatch;                        // how it is opened next
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

  // The files of one folder that wait to be described.
  struct Waiting {
    // Files that were not described yet, or only in a batch that took too long.
    std::vector<std::string> untried;
    // Files that were described alone, without success.
    std::vector<std::string> tried;
    std::size_t next_untried = 0;
    std::size_t next_tried = 0;

    bool HasUntried() const { return next_untried < untried.size(); }
    bool IsEmpty() const { return !HasUntried() && next_tried == tried.size(); }
  };

  // Returns false while the path's storage hangs.
  bool Answers(const std::string& path);
  static std::optional<Stamp> StampOf(const std::string& path);
  // Examines all files, and notes in waiting_ which of them must be opened.
  void See(const std::vector<ListedFolder>& folders);
  bool See(const std::string& path);
  // Describes files of waiting_ until the turn ends.
  void DescribeWaiting();
  // Takes the next files from `waiting`, which are described together.
  std::vector<std::string> NextBatch(Waiting& waiting);
  void DescribeBatch(const std::vector<std::string>& batch);
  // Returns what is known about the files.
  std::vector<absl::StatusOr<storm_files::StormFile>> Descriptions(
      const std::vector<std::string>& paths);
  std::vector<std::string> KnownBelow(const std::string& folder) const;
  // Logs each reason once.
  void ReportOnce(const absl::Status& why, bool is_warning);
  absl::StatusOr<storm_files::StormFile> DescribeTogether(const std::vector<std::string>& paths);
  void DescribeTogether(const std::vector<std::string>& paths, std::vector<std::uint64_t> versions,
                        KnownTogether& known);
  void BeginTogether();
  // Returns whether the files of a time in this folder may be described now.
  bool MayDescribeTogether(const std::string& folder);
  bool ForgetUnseen();
  void EndTurn(Result& result);
  // Returns whether the file must be opened now.
  bool Look(const Stamp& stamp, Known& known);
  bool MustOpen(const Known& known) const;
  // Stores in `known` the description of a file that was opened, or why it has none.
  void Take(const std::string& path, absl::StatusOr<storm_files::StormFile> file, Known& known);
  void Lose(Known& known);  // removes the description
  void LookAgainAt(Time time);

  const Options options_;
  std::atomic<bool> stopping_ = false;
  base::TimedCalls calls_;
  FoundByPath found_;
  std::set<std::string> hanging_;  // paths whose storage hangs
  std::map<std::string, Known> known_;
  // The times that are spread over several files, by the paths of these files.
  std::map<std::vector<std::string>, KnownTogether> together_;
  std::set<std::string> reported_;  // reasons that were logged, and notes about storms
  LeftOutLog left_out_;
  Time now_;  // the time of the scan in progress
  FairFolders turns_;
  Time turn_ends_;
  std::map<std::string, Waiting, FolderOrder> waiting_;  // by folder
  // Whether a file took too long and must be described again by the next scan.
  bool is_unfinished_ = false;
  // Whether a file that took too long was in a batch, and must be described alone.
  bool has_untried_ = false;
  // Folders with times that are spread over several files. Those in waiting_together_ wait for the
  // next scan. Those in served_together_ waited for this scan, which serves them while time
  // remains. It serves first_together_ in any case.
  FolderSet waiting_together_;
  FolderSet served_together_;
  std::string first_together_;
  bool had_waited_together_ = false;
  // When the scan stops to describe times that are spread over several files. It is set when the
  // scan comes to the first of them.
  std::optional<Time> together_ends_;
  std::uint64_t scans_ = 0;
  std::uint64_t versions_ = 0;
  bool changed_ = true;
  std::optional<Time> look_again_at_;
};

}  // namespace thunderhead::storm_store
