// A loopback address that only this process uses. A port that is free at this address stays free
// for the process, so that it can start a program there again.
#pragma once

#include <unistd.h>

#include <string>

#include "absl/strings/str_cat.h"

namespace thunderhead::testing {

inline std::string OwnHost() {
  const pid_t process = getpid();
  return absl::StrCat("127.", 1 + (process >> 16 & 127), ".", process >> 8 & 255, ".",
                      process & 255);
}

}  // namespace thunderhead::testing
