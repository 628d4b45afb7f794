// The manifest: a file with one line of JSON for each complete product, written after the product.
// It records from which input file each product was made, and shows which products need not be made
// again.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace thunderhead::pipeline {

// The input file of a product, in its state when the product was made.
struct InputFile {
  std::string path;
  std::uint64_t bytes = 0;
  std::int64_t modified_ns = 0;  // nanoseconds since 1970
  std::string sha256;
};

struct ManifestEntry {
  std::string file;  // relative to the manifest's folder
  std::uint64_t bytes = 0;
  std::string sha256;
  std::string storm;
  std::string valid;               // valid time, ISO 8601, UTC
  std::optional<std::string> run;  // start of the run, in the same format
  std::optional<double> lead_s;
  std::string view;
  std::string scene_sha256;
  std::string version;
  std::string device;
  double milliseconds = 0.0;
  std::optional<double> estimated_error;
  // The 95 % confidence interval of the error. Absent if the error was not measured but taken from
  // a table.
  std::optional<double> error_low;
  std::optional<double> error_high;
  InputFile input;
};

// Returns one line without the line break.
std::string ToLine(const ManifestEntry& entry);
// Parses a line. INVALID_ARGUMENT if ToLine cannot have written it.
absl::StatusOr<ManifestEntry> FromLine(std::string_view line);

// The other manifests in the folder of a manifest.
struct OtherManifests {
  std::vector<std::string> count;  // manifests whose products count as finished too
  // Manifests of processes that have ended and that each made a share of the pictures (Shard in
  // plan.h). Their lines are moved into this manifest, and the files are deleted. A manifest whose
  // lock another process still holds is treated like those in `count`.
  std::vector<std::string> take_over;
};

// The manifest of one process. The file is locked as long as this object exists. The lock also ends
// if the process is killed.
class Manifest {
 public:
  // Opens the manifest, and creates it if it does not exist. Drops an incomplete last line. Returns
  // DATA_LOSS if any other line is not an entry, and UNAVAILABLE if another process holds the
  // manifest's lock. Returns FAILED_PRECONDITION for anything but a regular file with a single
  // hard link, and for a file of more than 1 GiB. Otherwise returns the errors of
  // base::WriteProblem.
  static absl::StatusOr<Manifest> Open(const std::string& path, const OtherManifests& others);
  Manifest(Manifest&& other) noexcept;
  Manifest& operator=(Manifest&&) = delete;
  ~Manifest();

  // Returns the entry of the product at `path`, or null. An entry of this manifest takes
  // precedence, then the newest entry of the other manifests.
  const ManifestEntry* Find(const std::string& path) const;

  // Returns the entries of all products, chosen as by Find.
  std::vector<ManifestEntry> Entries() const;
  // Returns the path of an entry's product.
  std::string PathOf(const ManifestEntry& entry) const;
  // Returns the name under which entries refer to the product at `path`.
  std::string NameOf(const std::string& path) const;

  // Adds the entry of the product at `path`, and removes an older entry of it from any manifest.
  // Sets `entry.file`. Returns once the entry is durable.
  absl::Status Record(const std::string& path, ManifestEntry entry);

  const std::string& Path() const { return path_; }

 private:
  Manifest(std::string path, int file) : path_(std::move(path)), file_(file) {}

  // An entry of another manifest.
  struct Other {
    std::string manifest;
    ManifestEntry entry;
  };

  absl::Status ReadOther(const std::string& manifest);
  absl::Status TakeOver(const std::vector<std::string>& manifests);
  absl::Status RemoveFromOthers(const std::string& name);
  absl::Status Append(const ManifestEntry& entry) const;
  absl::Status Rewrite();

  std::string path_;
  // File descriptor of the locked file; -1 if none.
  int file_;
  std::vector<ManifestEntry> entries_;  // entries of this manifest, in order
  // Entries of the other manifests by product, the newest last.
  std::map<std::string, std::vector<Other>> others_;
  // Other manifests whose locks other processes hold.
  std::set<std::string> held_;
};

}  // namespace thunderhead::pipeline
