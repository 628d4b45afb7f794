// Decides when a file that a model is writing, or that is being copied, is complete. Plain values:
// the input is the state of a folder, the output is the reason why a file is not ready. A ready
// file must still be opened to check that it is complete.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/time/time.h"

namespace thunderhead::pipeline {

// A file of a folder, as seen by one scan.
struct SeenFile {
  std::string name;
  std::uint64_t bytes = 0;
  std::int64_t modified_ns = 0;  // nanoseconds since 1970
  absl::Duration unchanged;      // time without a change, by a monotonic clock
};

class ReadinessPolicy {
 public:
  // Parses a policy, which says when a file is ready. The policies are:
  //
  //   open                         the file has not changed for two seconds
  //
  //   age:SECONDS[,minsize:BYTES]  it has not changed for SECONDS and has at least BYTES
  //
  //   next[,age:SECONDS]           the folder has a file with a later name, or age:SECONDS holds
  //
  //   marker:GLOB                  the folder has a marker file whose name matches GLOB. GLOB has
  //                                one star, which stands for the end of the data file's name,
  //                                with or without its extension.
  //
  // INVALID_ARGUMENT for anything else.
  static absl::StatusOr<ReadinessPolicy> Parse(std::string_view text);

  // Returns why `file` is not ready, as text for people; none if it is ready. `files` are the data
  // files of its folder, `names` the names of all files there.
  std::optional<std::string> WaitsFor(const SeenFile& file, const std::vector<SeenFile>& files,
                                      const std::vector<std::string>& names) const;

  // Returns true for the name of a marker file, which is not a data file.
  bool IsMarker(std::string_view name) const;

  // Returns how long to wait before a folder with files that are not ready is scanned again.
  absl::Duration Patience() const;

 private:
  enum class Kind { kOpen, kAge, kNext, kMarker };

  Kind kind_ = Kind::kOpen;
  std::optional<absl::Duration> age_;
  std::uint64_t min_bytes_ = 0;
  std::string marker_;
};

}  // namespace thunderhead::pipeline
