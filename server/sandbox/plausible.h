// Checks values from the reader of a storm file, which other libraries rely on. A reader that a
// file has taken over may send anything.
#pragma once

#include "absl/status/status.h"
#include "storm_files/storm_file.h"
#include "storm_files/vertical_remap.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::sandbox {

// Each function returns INVALID_ARGUMENT, naming the member at fault, if a value is implausible.
absl::Status CheckPlausible(const storm_files::StormFile& file);
absl::Status CheckPlausible(const storm_files::VerticalGrid& grid);
// `file` is the description of the fields' file. A different number of columns means that the file
// was replaced, or that the reader lies.
absl::Status CheckPlausible(const volume::HydrometeorFields& fields,
                            const storm_files::StormFile& file);

}  // namespace thunderhead::sandbox
