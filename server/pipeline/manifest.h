// The manifest has one line of JSON for each complete product, written after the product. It
// records which file each picture was made from, and shows what need not be drawn again.
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

// The input file of a product, in its state at that time.
struct InputFile {
  std::string path;
  std::uint64_t bytes = 0;
  std::int64_t modified_ns = 0;  // since 1970
  std::string sha256;
};

struct ManifestEntry {
  std::string file;  // relative to the manifest's folder
  std::uint64_t bytes = 0;
  std::string sha256;
  std::string storm;
  std::string valid;               // ISO 8601, UTC
  std::optional<std::string> run;  // start of the run, in the same format
  std::optional<double> lead_s;
  std::string view;
  std::string scene_sha256;
  std::string version;
  std::string device;
  double milliseconds = 0.0;
  std::optional<double> estimated_error;
  // The 95 % interval; absent if the error was taken from a table and not measured.
  std::optional<double> error_low;
  std::optional<double> error_high;
  InputFile input;
};

// Returns one line without the line break.
std::string ToLine(const ManifestEntry& entry);
// INVALID_ARGUMENT if ToLine cannot have written the line.
absl::StatusOr<ManifestEntry> FromLine(std::string_view line);

// The other manifests in a manifest's folder.
struct OtherManifests {
  std::vector<std::string> count;  // manifests whose products count as done, too
  // Manifests of shares that have ended. Their lines are moved into this manifest, and they are
  // deleted. A manifest that a process still holds is treated like those in `count`.
  std::vector<std::string> take_over;
};

// The manifest of one process. The process holds its lock until it ends for any reason.
class Manifest {
 public:
  // Creates the manifest if it does not exist. Drops an incomplete last line. DATA_LOSS if another
  // line is not an entry; UNAVAILABLE if another process holds the manifest.
  static absl::StatusOr<Manifest> Open(const std::string& path, const OtherManifests& others);
  Manifest(Manifest&& other) noexcept;
  Manifest& operator=(Manifest&&) = delete;
  ~Manifest();

  // Returns the entry of the product at `path`, or null. This manifest's entry comes first, then
  // that of the other manifest that was written last.
  const ManifestEntry* Find(const std::string& path) const;

  // Returns the same for all products.
  std::vector<ManifestEntry> Entries() const;
  // Returns the path of an entry's product.
  std::string PathOf(const ManifestEntry& entry) const;
  // Returns the name in entries of the product at `path`.
  std::string NameOf(const std::string& path) const;

  // Adds the entry of the product at `path` and removes an older one from any manifest. Returns
  // when the entry is durable. Sets `entry.file`.
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
  int file_;                                          // locked; -1: none
  std::vector<ManifestEntry> entries_;                // of this manifest, in order
  std::map<std::string, std::vector<Other>> others_;  // by product, newest last
  std::set<std::string> held_;                        // other manifests that a process holds
};

}  // namespace thunderhead::pipeline
