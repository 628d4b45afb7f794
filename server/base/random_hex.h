// Random names: nobody can guess one, or derive one from another.
#pragma once

#include <string>

namespace thunderhead::base {

// `words` times 32 random bits of the operating system, each as 8 hexadecimal digits.
std::string RandomHex(int words);

}  // namespace thunderhead::base
