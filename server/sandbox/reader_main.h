// The program thunderhead-reader: the confined process that reads one storm file and nothing else.
// The program starts it (started_reader.h) with the open file and memory for large arrays as the
// descriptors below. It takes requests on its standard input, one after another, and answers on its
// standard output.
#pragma once

#include "storm_files/storm_format.h"

namespace thunderhead::sandbox {

// The program's file name, and its first argument.
inline constexpr char kReaderName[] = "thunderhead-reader";

inline constexpr int kFileDescriptor = 3;
inline constexpr int kSharedDescriptor = 4;

// Returns the exit status. The caller ends the process by _exit, as destructors of what a
// hostile file may have overwritten must not run.
int ReadStormFile(const storm_files::StormFormats& formats);

}  // namespace thunderhead::sandbox
