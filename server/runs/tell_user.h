// Messages of a command to its user. They are not log lines.
#pragma once

#include <iostream>
#include <string_view>

#include "base/utf8.h"

namespace thunderhead::runs {

// Writes one line to standard error. The line is made printable because it may contain names of
// files.
inline void TellUser(std::string_view what) {
  std::cerr << "thunderhead: " << base::Printable(what, {.max_bytes = base::kMaxLineBytes})
            << std::endl;
}

}  // namespace thunderhead::runs
