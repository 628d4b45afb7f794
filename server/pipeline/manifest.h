// The manifest: one line of JSON for each product that is whole, written after it. It tells which
// file made which picture, and what need not be drawn again.
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

// The file that a product was made of, as it was then.
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
  std::optional<std::string> run;  // the same
  std::optional<double> lead_s;
  std::string view;
  std::string scene_sha256;
  std::string version;
  std::string device;
  double milliseconds = 0.0;
  std::optional<double> estimated_error;
  // The 95 % interval; none where the error was not measured but taken from a table.
  std::optional<double> error_low;
  std::optional<double> error_high;
  InputFile input;
};

// One line, without its end.
std::string ToLine(const ManifestEntry& entry);
// INVALID_ARGUMENT for what ToLine does not write.
absl::StatusOr<ManifestEntry> FromLine(std::string_view line);

// The manifests beside a manifest.
struct OtherManifests {
  std::vector<std::string> count;  // their products count as well
  // Those of shares that have ended: their lines move to the manifest, and they are deleted. One
  // that a process still holds counts as the others.
  std::vector<std::string> take_over;
};

// The manifest of one process, which holds it until it ends, however that happens.
class Manifest {
 public:
  // Creates it if it does not exist. Drops a last line that is torn; another that is no entry is
  // DATA_LOSS. UNAVAILABLE if another process holds it.
  static absl::StatusOr<Manifest> Open(const std::string& path, const OtherManifests& others);
  Manifest(Manifest&& other) noexcept;
  Manifest& operator=(Manifest&&) = delete;
  ~Manifest();

  // The entry of the product at `path`, or null: that of this manifest, else of the other that was
  // written to last.
  const ManifestEntry* Find(const std::string& path) const;

  // The same of every product.
  std::vector<ManifestEntry> Entries() const;
  // Where an entry's product is.
  std::string PathOf(const ManifestEntry& entry) const;
  // The name by which entries know the product at `path`.
  std::string NameOf(const std::string& path) const;

  // Adds the entry of the product at `path`, in place of an older one wherever that is, and returns
  // when it is on the disk. `entry.file` is set here.
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
  std::map<std::string, std::vector<Other>> others_;  // by product, the newest last
  std::set<std::string> held_;                        // others that a process keeps
};

}  // namespace thunderhead::pipeline
