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
// `file` is the description of the fields' file. A different number of columns is an error: the
// file was replaced, or the reader was taken over.
absl::Status CheckPlausible(const volume::HydrometeorFields& fields,
                            const storm_files::StormFile& file);

}  // namespace thunderhead::sandbox
