// The program thunderhead-reader: the confined process that reads one storm file and nothing else.
// The server starts it (started_reader.h) with two open descriptors: the storm file, and memory for
// large arrays. The reader receives requests on its standard input, one after another, and sends
// its replies to its standard output.
#pragma once

#include "storm_files/storm_format.h"

namespace thunderhead::sandbox {

// The program's file name, and its first argument.
inline constexpr char kReaderName[] = "thunderhead-reader";

inline constexpr int kFileDescriptor = 3;
inline constexpr int kSharedDescriptor = 4;

// Runs the reader and returns the exit status. The caller must end the process by _exit, because a
// hostile file may have overwritten objects whose destructors would then run.
int ReadStormFile(const storm_files::StormFormats& formats);

}  // namespace thunderhead::sandbox
