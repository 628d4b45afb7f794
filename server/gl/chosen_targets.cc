#include "gl/chosen_targets.h"

#include <spdlog/spdlog.h>

#include <string_view>

namespace thunderhead::gl {

std::optional<bool> ComputesByChoice(const char* chosen) {
  if (chosen == nullptr) return std::nullopt;
  const std::string_view text(chosen);
  if (text == "compute") return true;
  if (text == "raster") return false;
  spdlog::error(
      "THUNDERHEAD_WHOLE_TARGETS is '{}' and has no effect; set it to raster or compute, or unset "
      "it",
      text);
  return std::nullopt;
}

}  // namespace thunderhead::gl
