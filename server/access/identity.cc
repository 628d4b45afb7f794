#include "access/identity.h"

#include <array>
#include <utility>

#include "absl/status/status.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"

namespace thunderhead::access {
namespace {

constexpr std::array kNames = {
    std::pair{Role::kViewer, "viewer"},
    std::pair{Role::kPresenter, "presenter"},
    std::pair{Role::kPipeline, "pipeline"},
    std::pair{Role::kOperator, "operator"},
};

}  // namespace

absl::StatusOr<Role> ParseRole(std::string_view text) {
  for (const auto& [role, name] : kNames) {
    if (text == name) return role;
  }
  return absl::InvalidArgumentError(
      absl::StrCat("'", std::string(text),
                   "' is not a role; the roles are viewer, presenter, pipeline and operator"));
}

const char* NameOf(Role role) {
  for (const auto& [one, name] : kNames) {
    if (one == role) return name;
  }
  return "unknown";
}

}  // namespace thunderhead::access
