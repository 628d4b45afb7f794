// The storms that a server holds: a catalogue of the storms found under some paths, and a cache of
// recently used times with a byte budget. The catalogue can follow changes of the paths. A separate
// thread reads the next times ahead. The store is safe to call from any thread. NetCDF-C is not
// thread-safe, so one reader works at a time in this process. While a storage blocks that reader,
// other files can be read only in another process (StormFormats::LeaveTo).
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
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
#include "volume/map_projection.h"

namespace thunderhead::storm_store {

// One time (time step) of a storm.
struct StormTime {
  std::string valid_time;  // ISO 8601, UTC, e.g. "0001-01-01T00:40:00Z"
  double elapsed_s = 0.0;  // seconds since the storm's first time
  // Seconds since the run's start, or since the storm's first time if that is unknown, in the
  // calendar of the files.
  double lead_s = 0.0;
  // True if the file is gone, but its fields in memory are still in use.
  bool deleted = false;
  std::string file = {};  // the path; empty for a storm without files
  // StormFile::version of `file`, or 0 for a storm without files.
  std::uint64_t version = 0;
  // The middle of the domain at this time, if the domain moves. Otherwise use StormInfo.
  std::optional<volume::EarthPlace> middle = {};
  // The grid's map projection at this time. Absent if it is that of StormInfo, and an empty text if
  // there is none at this time.
  std::optional<std::string> projection = {};

  bool operator==(const StormTime&) const = default;
};

// Description of a storm, available without reading its fields.
struct StormInfo {
  std::string id;     // unique in a store; from the file's or folder's name
  std::string title;  // title for users, from the file's global attributes
  std::vector<std::string> files;
  std::string path;              // the path that names this storm alone, if it is in one file
  std::vector<StormTime> times;  // in order of valid time
  glm::ivec3 file_cells{0};      // west-east, south-north, bottom-top, as in the file
  // The distances between columns at the first time. Those of other times can differ if the domain
  // moves.
  double dx_m = 0.0;
  double dy_m = 0.0;
  std::vector<physics::Hydrometeor> fields;  // fields in the file
  std::optional<double> latitude_deg;        // latitude of the middle of the domain at the first
                                             // time; nothing if idealised
  std::optional<double> longitude_deg;
  std::optional<std::string> run_start;  // start of the model run, in the format of valid times;
                                         // nothing if unknown
  // The grid's map projection at the first time, in PROJ's notation. volume::MapProjection::Of
  // accepts it, with the middle of the domain at latitude_deg and longitude_deg. It is empty if the
  // grid has no projection.
  std::string projection;
  // The direction of true north in the middle of the domain, in degrees clockwise from the grid's
  // north (the world's y axis), at the first time. It is 0 without a projection.
  double true_north_deg = 0.0;
  // The reader's assumptions where the files say nothing, for users. Each text is one sentence.
  std::vector<std::string> assumptions;
};

// Returns the place of the domain's middle at a time of the storm, or nothing for an idealised run.
inline std::optional<volume::EarthPlace> MiddleOf(const StormInfo& storm, std::size_t time_index) {
  if (time_index < storm.times.size() && storm.times[time_index].middle.has_value()) {
    return storm.times[time_index].middle;
  }
  if (!storm.latitude_deg.has_value() || !storm.longitude_deg.has_value()) return std::nullopt;
  return volume::EarthPlace{*storm.latitude_deg, *storm.longitude_deg};
}

// Returns the map projection at a time of the storm, in PROJ's notation. It is empty if the grid
// has none.
inline const std::string& ProjectionTextOf(const StormInfo& storm, std::size_t time_index) {
  const bool own =
      time_index < storm.times.size() && storm.times[time_index].projection.has_value();
  return own ? *storm.times[time_index].projection : storm.projection;
}

// Returns the map projection of a storm's world coordinates at a time, or nothing for a storm
// without one.
std::optional<volume::MapProjection> ProjectionOf(const StormInfo& storm, std::size_t time_index);

// Returns StormInfo::true_north_deg at a time of the storm.
double TrueNorthOf_deg(const StormInfo& storm, std::size_t time_index);

// A description never changes. A storm that grows gets a new description.
using StormInfoPtr = std::shared_ptr<const StormInfo>;

// Returns one line that names the part of the world that the storm's model covers. All runs over
// that part, and all idealised runs on equal grids, have the same line.
std::string DomainOf(const StormInfo& storm);

// A storm before and after a change of the files. `before` is null for a new storm, and `after` is
// null for a removed one.
struct StormChange {
  StormInfoPtr before;
  StormInfoPtr after;
};
using CatalogueChange = std::vector<StormChange>;

// A function that is called on the thread that found the change.
using CatalogueListener = std::function<void(const CatalogueChange&)>;

// A function that is called on the reading thread with the part of the read that is done, 0 to 1.
using ReadProgress = std::function<void(double)>;

class BorderData;

// Options for a store that follows changes in its folders. It uses the kernel's events where
// available, and a slow rescan. The rescan also finds changes that another machine makes on a
// network file system.
struct LiveCatalogueOptions {
  std::chrono::milliseconds rescan{30'000};
  // A file whose size or change time has changed within this period is assumed to be still being
  // written.
  std::chrono::milliseconds settle{3'000};
  // The longest time for which Open waits for the first search. If the search takes longer, it
  // continues in the background, and the storms appear at its end.
  std::chrono::milliseconds first_search{std::chrono::minutes(10)};
  // The ids that an earlier store gave to its storms, as `keep_ids` got them. May be empty.
  std::string ids = {};
  // A function that keeps the storms' ids for the next store. It is called on the searching thread
  // when they have changed. It may be empty.
  std::function<void(const std::string& ids)> keep_ids = {};
};

// Rules for the symbolic links that a search for storms follows. Links into the searched paths are
// always followed.
struct LinkPolicy {
  std::vector<std::string> allowed;  // other folders that links may lead to
  std::vector<std::string>
      untrusted;  // folders to which other users may write; links in these folders are not followed
};

// Follows every link. Use it only for commands that users run on their own files, with their own
// rights.
inline LinkPolicy EveryLink() { return {.allowed = {"/"}, .untrusted = {}}; }

struct StormStoreOptions {
  // The maximum size in bytes of all cached times. The most recently used time and times in use are
  // kept even if they exceed it.
  std::size_t byte_budget = std::size_t{2} << 30;
  // The memory budget in which all times in memory are reserved, cached or not. Null means no
  // limit.
  std::shared_ptr<base::MemoryBudget> memory;
  int read_ahead = 1;  // number of times to read ahead after each Get
  // A storage on which a read makes no progress for this long counts as hanging.
  std::chrono::milliseconds read_deadline{60'000};
  storm_files::StormFormats formats = storm_files::StormFormats::BuiltIn();
  LinkPolicy links = {};
  // A request to stop ends Open with CANCELLED, unless the store follows changes.
  std::stop_token stop = {};
  // Coasts and borders for storms with a place on Earth, or null.
  std::shared_ptr<BorderData> borders;
  // If present, the store follows changes in the folders, and a folder without storms is not an
  // error. If absent, the store keeps the storms that Open finds.
  std::optional<LiveCatalogueOptions> live;
  // The time source for timeouts and pauses, and for how long a file must stay unchanged before it
  // counts as complete (LiveCatalogueOptions::settle). It must outlive the store, and also any
  // thread of the store that is still blocked by a hanging storage when the store ends.
  const base::TimeSource* time = &base::SteadyTime();
};

// A read that makes no progress because its storage hangs.
struct HungRead {
  std::string file;
  double seconds = 0.0;      // seconds without progress so far
  std::uint64_t device = 0;  // StormFile::device of the file
};

class StormStore {
 public:
  // Opens every storm under `paths` and reads only metadata. A file is one storm, or several storms
  // such as the members of an ensemble. A folder is one series if its files continue one another
  // (same grid, different times). Otherwise each of its files or sub-folders is a storm. If a given
  // path cannot be used, the error names the file, the variable and what to do. A file in a folder
  // that cannot be read as a storm is logged and skipped. Without StormStoreOptions::live, finding
  // no storm at all is an error.
  static absl::StatusOr<std::unique_ptr<StormStore>> Open(const std::vector<std::string>& paths,
                                                          const StormStoreOptions& options);
  virtual ~StormStore() = default;

  // Returns the storms. First come the opened storms, in the order of the paths and by id within a
  // path. Then come the storms whose files are gone but whose fields are in use, and the added
  // storms.
  virtual std::vector<StormInfoPtr> Storms() const = 0;

  // Adds the storm of a file. Returns ALREADY_EXISTS if another storm has its id, and
  // INVALID_ARGUMENT if the file has several storms. Other errors are those of Open.
  virtual absl::StatusOr<StormInfoPtr> Add(const std::string& path) = 0;

  // Removes a storm from the store, so that it is no longer listed, found or read. Its files stay.
  // Returns NOT_FOUND for an unknown id.
  virtual absl::Status Remove(std::string_view id) = 0;

  // Returns the storm with that id, or null.
  StormInfoPtr Find(std::string_view id) const;

  // Returns the fields of one time, from the cache or by reading the file now (blocking).
  // `time_index` is an index into the storm's times. `progress` may be empty. Errors: NOT_FOUND
  // (id), OUT_OF_RANGE (time), RESOURCE_EXHAUSTED (not enough memory), DEADLINE_EXCEEDED (the
  // storage of this time's file hangs), and the errors of the file's reader. If the storage is
  // already known to hang, DEADLINE_EXCEEDED is returned at once.
  virtual absl::StatusOr<std::shared_ptr<const volume::HydrometeorFields>> Get(
      std::string_view id, int time_index, const ReadProgress& progress) = 0;

  // Returns the fields if they are in the cache, else null. Reads nothing.
  virtual std::shared_ptr<const volume::HydrometeorFields> Peek(std::string_view id,
                                                                int time_index) = 0;

  // Returns the indices of the storm's times that are in the cache, in order, or none for an
  // unknown id.
  virtual std::vector<int> TimesInMemory(std::string_view id) const = 0;

  // Returns true until the first search of the folders has ended. Until then, storms may still be
  // missing.
  virtual bool IsSearching() const { return false; }

  // Returns the bytes of all cached times.
  virtual std::size_t CachedBytes() const = 0;

  // Returns the number of times that are being read or are queued, including times to be read
  // ahead.
  virtual std::size_t PendingReads() const { return 0; }

  // Returns a read that hangs now, if there is one.
  virtual std::optional<HungRead> Hung() const { return std::nullopt; }

  // Reports every later change that the store finds itself to `listener`. An empty listener ends
  // the reports; Listen then waits for a running call to return. Without StormStoreOptions::live
  // there are no changes.
  virtual void Listen(CatalogueListener /*kept*/) {}  // NOLINT(performance-unnecessary-value-param)
};

}  // namespace thunderhead::storm_store
