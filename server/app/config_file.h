// Settings of a command in a file: the command's flags without their dashes, one a line, as
// `max-sessions = 200`. Flags on the command line take precedence. A setting with an empty value
// keeps its default.
#pragma once

#include <string>

#include "CLI/CLI.hpp"
#include "absl/status/status.h"

namespace thunderhead::app {

// Gives the settings of the file at `path` to those options of `command` that the command line does
// not have. INVALID_ARGUMENT, naming the file and the setting, if there is no such file, or for
// a setting that does not exist or has a wrong value.
absl::Status ReadConfigFile(CLI::App& command, const std::string& path);

// Returns a file with every option of `command` that such a file can set, its meaning, and its
// value now: that of the command line or the default.
std::string ConfigFileOf(const CLI::App& command);

}  // namespace thunderhead::app
