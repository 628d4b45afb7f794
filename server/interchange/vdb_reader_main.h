// The program thunderhead-vdb-reader: the confined process that reads one grid of an OpenVDB file
// (sandbox/reader_process.h).
#pragma once

namespace thunderhead::interchange {

// The program's file name.
inline constexpr char kVdbReaderName[] = "thunderhead-vdb-reader";

// Runs the reader and returns the exit status. The caller must end the process by _exit.
int ReadVdbFile();

}  // namespace thunderhead::interchange
