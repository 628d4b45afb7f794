// When a file that a model writes, or somebody copies, is complete. Plain values: what a folder
// looks like goes in, what a file waits for comes out. A file that is ready must still open.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/time/time.h"

namespace thunderhead::pipeline {

// A file of a folder, as seen by a look at it.
struct SeenFile {
  std::string name;
  std::uint64_t bytes = 0;
  std::int64_t modified_ns = 0;  // since 1970
  absl::Duration unchanged;      // for how long, by a clock that is not set
};

class ReadinessPolicy {
 public:
  // One of
  //   open                         does not change for two seconds
  //   age:SECONDS[,minsize:BYTES]  does not change for SECONDS, and has at least BYTES
  //   next[,age:SECONDS]           a file of a later name is there, or as age
  //   marker:GLOB                  a file is there whose name is GLOB with the end of this file's
  //                                name (or of its name without its ending) for GLOB's one star
  // INVALID_ARGUMENT for anything else.
  static absl::StatusOr<ReadinessPolicy> Parse(std::string_view text);

  // Why `file` waits, for people; nothing if it is ready. `files` are the data files of its
  // folder, `names` all names there.
  std::optional<std::string> WaitsFor(const SeenFile& file, const std::vector<SeenFile>& files,
                                      const std::vector<std::string>& names) const;

  // True for a name that marks a file, which is no data file itself.
  bool IsMarker(std::string_view name) const;

  // How soon a look at a folder with unready files may bring something new.
  absl::Duration Patience() const;

 private:
  enum class Kind { kOpen, kAge, kNext, kMarker };

  Kind kind_ = Kind::kOpen;
  std::optional<absl::Duration> age_;
  std::uint64_t min_bytes_ = 0;
  std::string marker_;
};

}  // namespace thunderhead::pipeline
