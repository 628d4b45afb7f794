// The function of the library `lib/thunderhead/vdb-writer.so`, which is loaded when the first
// OpenVDB file is written. If the program were linked with OpenVDB, each of its starts would take
// twice as long.
#pragma once

#include <functional>
#include <stop_token>
#include <string>

#include "interchange/vdb_file.h"

namespace thunderhead::interchange {

enum class VdbWritten { kWhole, kStopped, kFailed };

}  // namespace thunderhead::interchange

// Writes the file to `path`, with the arguments of interchange::WriteVdb. `why` receives the reason
// of a failure. Throws no exceptions.
extern "C" thunderhead::interchange::VdbWritten ThunderheadWriteVdb(
    const thunderhead::interchange::VdbFile& file, const std::string& path,
    const std::function<void(double share)>& progress, const std::stop_token& stop,
    std::string& why);
