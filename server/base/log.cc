#include "base/log.h"

#include <cstdio>
#include <string>

namespace thunderhead::base {

void LogError(const absl::Status& error) {
  std::fprintf(stderr, "thunderhead: %s\n", std::string(error.message()).c_str());
}

}  // namespace thunderhead::base
