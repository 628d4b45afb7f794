// Reads a grid of an untrusted OpenVDB file by a confined process.
#pragma once

#include <stop_token>
#include <string>

#include "absl/status/statusor.h"
#include "interchange/vdb_volume.h"
#include "storm_files/storm_file.h"

namespace thunderhead::interchange {

// Reads the grid named `grid` of the file at `path` by a process of `program`. If `program` is
// empty, it is thunderhead-vdb-reader next to this program. `checkpoint` may be empty. If `stop` is
// requested, the process is ended, and the error is CANCELLED. Other errors are
// those of ReadVdbGrid, and INVALID_ARGUMENT if the file does not begin like an OpenVDB file. The
// errors of a reader that fails are those of sandbox::Readers.
absl::StatusOr<VdbVolume> ReadVdb(const std::string& path, const std::string& grid,
                                  const storm_files::ReadCheckpoint& checkpoint,
                                  const std::string& program = "",
                                  const std::stop_token& stop = {});

}  // namespace thunderhead::interchange
