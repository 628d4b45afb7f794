// Finds out to which time of which storm a GRIB file belongs. Centres that write one file for each
// field and level spread a time over hundreds of files.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "grib/index.h"

namespace thunderhead::storm_files {

enum class GribPartKind {
  kWhole,      // hydrometeors and temperature on several levels: one or several whole times
  kFields,     // part of a time
  kInvariant,  // heights of levels (HHL) or of the ground, or places of cells (CLAT, CLON), which
               // are parts of all times
};

struct GribPart {
  GribPartKind kind = GribPartKind::kFields;
  // A text that is the same for all parts of one run and grid, and different for others. It is
  // empty for kWhole.
  std::string of;
  std::string member;             // as GribMemberOf returns it
  std::vector<absl::Time> times;  // valid times in ascending order; empty for kInvariant
};

// Returns what the file of `index` is, by its headers alone: one kWhole, or one part for each run,
// member and grid. Returns INVALID_ARGUMENT, which names the file, if it has no field that a storm
// needs.
absl::StatusOr<std::vector<GribPart>> GribPartsOf(const grib::Index& index);

// Returns a text that is the same for all fields of one run: "2024-05-20 21:00 UTC, centre 7/0".
std::string GribRunOf(const grib::Origin& origin);

// Returns the name of an ensemble's member, "mem05", or an empty text if there is none.
std::string GribMemberOf(std::optional<int> member);

}  // namespace thunderhead::storm_files
