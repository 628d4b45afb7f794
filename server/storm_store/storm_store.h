// The storms a server holds: a catalogue of series found under some paths, which may follow what
// happens there, and a cache of the times in use within a byte budget, which reads the next times
// ahead on a thread of its own. Safe to call from any thread; netCDF-C is not thread-safe, so one
// reader works at a time in this process. While a storage holds it up, others are read in another.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "base/memory_budget.h"
#include "base/time_source.h"
#include "storm_files/storm_file.h"
#include "storm_files/storm_format.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::storm_store {

// One of a storm's times.
struct StormTime {
  std::string valid_time;  // ISO 8601, UTC, e.g. "0001-01-01T00:40:00Z"
  double elapsed_s = 0.0;  // since the storm's first time
  // Its file is gone, but somebody still looks at what is in memory.
  bool deleted = false;
  std::string file = {};  // the path; empty for a storm without files
  // StormFile::version of that file; 0 for a storm without files.
  std::uint64_t version = 0;

  bool operator==(const StormTime&) const = default;
};

// Description of a storm, available without reading its fields.
struct StormInfo {
  std::string id;     // unique in a store; from the file's or folder's name
  std::string title;  // for people, from the file's global attributes
  std::vector<std::string> files;
  std::vector<StormTime> times;  // in order of valid time
  glm::ivec3 file_cells{0};      // west-east, south-north, bottom-top, as in the file
  double dx_m = 0.0;
  double dy_m = 0.0;
  std::vector<physics::Hydrometeor> fields;  // that the file has
  std::optional<double> latitude_deg;        // of the middle; nothing for an idealised run
  std::optional<double> longitude_deg;
  std::optional<std::string> run_start;  // as valid times; nothing if the files do not tell
  // Projection of the grid, whose middle is there, as PROJ writes it; empty if it has none.
  std::string projection;
};

// A description never changes; a storm that grows gets another.
using StormInfoPtr = std::shared_ptr<const StormInfo>;

// Names the part of the world that the storm's model covers: the same for each run over it, and for
// idealised runs of one grid. In a line.
std::string DomainOf(const StormInfo& storm);

// A storm before and after a change of the files; null before for a new one, and after for one that
// is gone.
struct StormChange {
  StormInfoPtr before;
  StormInfoPtr after;
};
using CatalogueChange = std::vector<StormChange>;

// Called on the thread that found the change.
using CatalogueListener = std::function<void(const CatalogueChange&)>;

// Called on the reading thread with the share done, 0 to 1.
using ReadProgress = std::function<void(double)>;

class BorderData;

// How a store follows what happens in its folders: by the kernel's events where there are any, and
// by a slow rescan, which also sees what happens on another machine's side of a network file
// system.
struct LiveCatalogueOptions {
  std::chrono::milliseconds rescan{30'000};
  // A file whose size or date has changed within this time is still being written.
  std::chrono::milliseconds settle{3'000};
  // How long Open waits for the first search. After that it goes on in the background, and storms
  // come when it has ended.
  std::chrono::milliseconds first_search{std::chrono::minutes(10)};
};

// Which symbolic links a search for storms follows. Links into the searched paths are always
// followed.
struct LinkPolicy {
  std::vector<std::string> allowed;  // folders that links may lead to besides
  std::vector<std::string>
      untrusted;  // folders in which others may put links, which are not followed
};

// Follows every link: for commands that a user runs on own files, with the user's own rights.
inline LinkPolicy EveryLink() { return {.allowed = {"/"}, .untrusted = {}}; }

struct StormStoreOptions {
  // Bytes of cached times; the newest one and those in use are kept even if they are more.
  std::size_t byte_budget = std::size_t{2} << 30;
  // The budget that times in memory count in, cached or not; null: none.
  std::shared_ptr<base::MemoryBudget> memory;
  int read_ahead = 1;  // times read ahead after each Get
  // A storage on which a read makes no progress for this long counts as hanging.
  std::chrono::milliseconds read_deadline{60'000};
  storm_files::StormFormats formats = storm_files::StormFormats::BuiltIn();
  LinkPolicy links = {};
  // Coasts and borders for storms with a place on Earth; null: none.
  std::shared_ptr<BorderData> borders;
  // Absent: the storms are those of the start. With it, a folder without storms is no error.
  std::optional<LiveCatalogueOptions> live;
  // The time that deadlines, pauses and settling files are measured by. It must outlive the store,
  // and a thread of the store's that hangs.
  const base::TimeSource* time = &base::SteadyTime();
};

// A read that its storage does not let go on.
struct HungRead {
  std::string file;
  double seconds = 0.0;      // so far
  std::uint64_t device = 0;  // StormFile::device of the file
};

class StormStore {
 public:
  // Opens every storm under `paths`: a file is one storm; a folder is one series where its files
  // continue one another (same grid, different times), else one storm a file or sub-folder. Reads
  // only metadata. Fails with one clear error (file, variable, what to do) if a given path cannot
  // be used. A file inside a folder that is not a storm is logged and skipped; finding no storm at
  // all is an error.
  static absl::StatusOr<std::unique_ptr<StormStore>> Open(const std::vector<std::string>& paths,
                                                          const StormStoreOptions& options);
  virtual ~StormStore() = default;

  // The storms: those opened, in the order of the paths and within a path of id, then those added,
  // in order of addition.
  virtual std::vector<StormInfoPtr> Storms() const = 0;

  // Adds the storm of a file. ALREADY_EXISTS if another has its id; else as Open.
  virtual absl::StatusOr<StormInfoPtr> Add(const std::string& path) = 0;

  // Removes a storm from the store: it is no longer listed, found or read. Its files stay.
  // NOT_FOUND for an unknown id.
  virtual absl::Status Remove(std::string_view id) = 0;

  // The storm of that id, or null.
  StormInfoPtr Find(std::string_view id) const;

  // The fields of one time: from the cache, or read now (blocking). `time_index` must be one of the
  // storm's. Errors: NOT_FOUND (id), OUT_OF_RANGE (time), RESOURCE_EXHAUSTED (no room in memory),
  // DEADLINE_EXCEEDED (this time's storage hangs; at once where that is known), and those of the
  // file's reader.
  // `progress` may be empty.
  virtual absl::StatusOr<std::shared_ptr<const volume::HydrometeorFields>> Get(
      std::string_view id, int time_index, const ReadProgress& progress) = 0;

  // The fields if they are in the cache, else null; reads nothing.
  virtual std::shared_ptr<const volume::HydrometeorFields> Peek(std::string_view id,
                                                                int time_index) = 0;

  // The indices of the storm's times that are in the cache, in order; none for an unknown id.
  virtual std::vector<int> TimesInMemory(std::string_view id) const = 0;

  // True until the first search of the folders has ended: there may be more storms than are known.
  virtual bool IsSearching() const { return false; }

  // Bytes of all cached times.
  virtual std::size_t CachedBytes() const = 0;

  // Times that are being read, or wait to be, for callers and ahead.
  virtual std::size_t PendingReads() const { return 0; }

  // The read that hangs now, if one does.
  virtual std::optional<HungRead> Hung() const { return std::nullopt; }

  // Tells `listener` of every change that the store finds by itself, from now on; an empty one ends
  // that, after a running call has returned. Without a live catalogue there is never one.
  virtual void Listen(CatalogueListener /*kept*/) {}  // NOLINT(performance-unnecessary-value-param)
};

}  // namespace thunderhead::storm_store
