#include "app/config_file.h"

#include <algorithm>
#include <filesystem>
#include <set>
#include <string>
#include <system_error>
#include <vector>

#include "absl/strings/str_cat.h"
#include "base/regular_file.h"
#include "base/status.h"

namespace thunderhead::app {
namespace {

absl::Status Set(CLI::Option& option, const CLI::ConfigItem& setting) {
  if (option.count() > 0) return absl::OkStatus();
  try {
    if (option.get_expected_max() == 0) {
      option.add_result(option.get_flag_value(setting.name, CLI::ConfigINI().to_flag(setting)));
    } else {
      option.add_result(setting.inputs);
    }
    option.run_callback();
  } catch (const CLI::Error& error) {
    return absl::InvalidArgumentError(error.what());
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status ReadConfigFile(CLI::App& command, const std::string& path) {
  THUNDERHEAD_RETURN_IF_ERROR(base::CheckRegularFile(path));
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    return absl::InvalidArgumentError(
        absl::StrCat(path, ": there is no such file; check --config"));
  }
  std::vector<CLI::ConfigItem> settings;
  try {
    settings = CLI::ConfigINI().from_file(path);
  } catch (const CLI::Error& unreadable) {
    return absl::InvalidArgumentError(absl::StrCat(path, ": ", unreadable.what()));
  }
  std::set<const CLI::Option*> set;
  for (const CLI::ConfigItem& setting : settings) {
    if (!setting.parents.empty()) {
      return absl::InvalidArgumentError(absl::StrCat(
          path, ": has a section [", setting.parents.front(),
          "]; write the settings without sections, each as its flag without the dashes"));
    }
    CLI::Option* const option = command.get_option_no_throw("--" + setting.name);
    if (option == nullptr || !option->get_configurable()) {
      return absl::InvalidArgumentError(absl::StrCat(path, ": there is no setting '", setting.name,
                                                     "'; `thunderhead ", command.get_name(),
                                                     " --print-config` lists them all"));
    }
    if (!set.insert(option).second) {
      return absl::InvalidArgumentError(absl::StrCat(
          path, ": ", setting.name,
          " is set a second time; write each setting once, and several values on one line"));
    }
    // ConfigFileOf writes an empty value for a setting that has none. Such a setting keeps its
    // default.
    if (std::ranges::all_of(setting.inputs, &std::string::empty)) continue;
    THUNDERHEAD_RETURN_IF_ERROR(
        base::Annotate(Set(*option, setting), absl::StrCat(path, ": ", setting.name)));
  }
  return absl::OkStatus();
}

std::string ConfigFileOf(const CLI::App& command) {
  constexpr bool kDefaultsToo = true;
  constexpr bool kWithMeaning = true;
  return CLI::ConfigINI().to_config(&command, kDefaultsToo, kWithMeaning, "") + "\n";
}

}  // namespace thunderhead::app
