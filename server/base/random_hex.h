// Random names that no one can guess or derive from one another.
#pragma once

#include <string>

namespace thunderhead::base {

// Returns `words` times 32 random bits of the operating system, each as 8 hexadecimal digits.
std::string RandomHex(int words);

}  // namespace thunderhead::base
