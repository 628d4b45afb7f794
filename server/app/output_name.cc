#include "app/output_name.h"

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"

namespace thunderhead::app {

absl::Status CheckEnding(const std::string& flag, const std::string& path,
                         std::initializer_list<const char*> endings) {
  const bool has_one = std::ranges::any_of(
      endings, [&](const char* ending) { return absl::EndsWithIgnoreCase(path, ending); });
  if (has_one) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(flag, " is '", path, "'; its name must end in ",
                                                 absl::StrJoin(endings, " or ")));
}

absl::Status CheckNotInput(const std::string& flag, const std::string& path,
                           const std::string& storm) {
  std::error_code error;
  if (!std::filesystem::equivalent(path, storm, error) || error) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat(flag, " would replace the storm file '", storm, "'; give another name"));
}

}  // namespace thunderhead::app
