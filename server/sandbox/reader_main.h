// The program in its other part: the process that reads one untrusted file and nothing else. The
// server starts it (reader_process.h) with a request on its standard input, the open file as the
// descriptor below, and takes what it says on its standard output.
#pragma once

#include "volume/storm_format.h"

namespace thunderhead::sandbox {

inline constexpr int kFileDescriptor = 3;

// The program's first argument by which it is this process.
inline constexpr char kReaderCommand[] = "read-untrusted-file";

// Returns the exit status. The caller ends the process by _exit, as destructors of what a
// hostile file may have overwritten must not run.
int ReadUntrustedFile(const volume::StormFormats& formats);

}  // namespace thunderhead::sandbox
