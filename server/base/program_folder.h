// The folder of the running program, next to which its other programs and files are installed.
#pragma once

#include <filesystem>

namespace thunderhead::base {

// Returns the folder of the running program, with all links resolved. Returns an empty path if the
// system does not tell it.
std::filesystem::path ProgramFolder();

}  // namespace thunderhead::base
