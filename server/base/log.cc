#include "base/log.h"

#include <string>

#include "spdlog/spdlog.h"

namespace thunderhead::base {

void LogError(const absl::Status& error) {
  const std::string message(error.message());
  spdlog::error("{}", message);
}

}  // namespace thunderhead::base
