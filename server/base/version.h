// The version of the program, set by the build from the project's one number.
#pragma once

#include <string>

namespace thunderhead::base {

std::string Version();

}  // namespace thunderhead::base
