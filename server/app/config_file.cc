#include "app/config_file.h"

#include <algorithm>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "base/named_file.h"
#include "base/status.h"

namespace thunderhead::app {
namespace {

constexpr std::size_t kMaxFile_bytes = 1 << 20;

// Returns the settings in the file. A key may contain dots. By default CLI11 would treat the parts
// before the dots as sections, and would ignore a key with very many dots.
absl::StatusOr<std::vector<CLI::ConfigItem>> ReadSettings(const std::string& path) {
  const absl::StatusOr<std::string> text = base::ReadBoundedFile(path, kMaxFile_bytes);
  if (!text.ok()) return base::Annotate(text.status(), "--config");
  std::istringstream lines(*text);
  CLI::ConfigINI parser;
  parser.parentSeparator('\0');
  try {
    return parser.from_config(lines);
  } catch (const CLI::Error& unreadable) {
    return absl::InvalidArgumentError(absl::StrCat(path, ": ", unreadable.what()));
  }
}

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
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<CLI::ConfigItem> settings, ReadSettings(path));
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
  std::string text =
      absl::StrCat("; Settings of `thunderhead ", command.get_name(),
                   "` for its flag --config. A line that begins with ; is a comment.\n",
                   CLI::ConfigINI().to_config(&command, kDefaultsToo, kWithMeaning, ""), "\n");
  // CLI11 writes the name of a group with the word "Options" after it, which is no plain heading.
  for (const std::string& group : command.get_groups()) {
    text = absl::StrReplaceAll(text, {{absl::StrCat("\n; ", group, " Options\n"),
                                       absl::StrCat("\n; ---- ", group, " ----\n")}});
  }
  return text;
}

}  // namespace thunderhead::app
