// Checks the values that the reader of a storm file has sent, because other libraries rely on them.
// A hostile file can take over its reader, which may then send any values.
#pragma once

#include "absl/status/status.h"
#include "storm_files/storm_file.h"
#include "storm_files/vertical_remap.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::sandbox {

// Each function returns INVALID_ARGUMENT, naming the member, if a value is implausible.
absl::Status CheckPlausible(const storm_files::StormFile& file);
absl::Status CheckPlausible(const storm_files::VerticalGrid& grid);
// `columns` is the number of columns that was requested. A different number is an error: the file
// was replaced, or the reader was taken over.
absl::Status CheckPlausible(const volume::HydrometeorFields& fields, const glm::ivec2& columns);

}  // namespace thunderhead::sandbox
