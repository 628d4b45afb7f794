// The program in its other part: the confined process that reads one storm file and nothing else.
// The program starts it (reader_process.h) with a request on its standard input and the open file
// and memory for large arrays as the descriptors below, and takes what it says on its standard
// output.
#pragma once

#include "volume/storm_format.h"

namespace thunderhead::sandbox {

inline constexpr int kFileDescriptor = 3;
inline constexpr int kSharedDescriptor = 4;

// The program's first argument by which it is this process.
inline constexpr char kReaderCommand[] = "read-storm-file";

// Returns the exit status. The caller ends the process by _exit, as destructors of what a
// hostile file may have overwritten must not run.
int ReadStormFile(const volume::StormFormats& formats);

}  // namespace thunderhead::sandbox
