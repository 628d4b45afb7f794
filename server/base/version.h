// The version of the program, which the build sets from the project's version number.
#pragma once

#include <string>

namespace thunderhead::base {

std::string Version();

}  // namespace thunderhead::base
