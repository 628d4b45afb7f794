// The program thunderhead-reader: the confined process that reads one storm file and nothing else
// (reader_process.h).
#pragma once

#include "sandbox/reader_process.h"
#include "storm_files/storm_format.h"

namespace thunderhead::sandbox {

// Runs the reader and returns the exit status. The caller must end the process by _exit, because a
// hostile file may have overwritten objects whose destructors would then run.
int ReadStormFile(const storm_files::StormFormats& formats);

}  // namespace thunderhead::sandbox
