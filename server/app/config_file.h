// Settings of a command in a file: the command's flags without their dashes, one per line, such as
// `max-sessions = 200`. Flags on the command line take precedence. A setting with an empty value
// keeps its default.
#pragma once

#include <string>

#include "CLI/CLI.hpp"
#include "absl/status/status.h"

namespace thunderhead::app {

// Applies the settings of the file at `path` to those options of `command` that the command line
// does not set. Returns INVALID_ARGUMENT, which names the file and the setting, if the file cannot
// be read, or a setting does not exist or has a wrong value. Returns FAILED_PRECONDITION if the
// path is not a regular file.
absl::Status ReadConfigFile(CLI::App& command, const std::string& path);

// Returns the text of a settings file with every option of `command` that such a file can set. Each
// option has its description and its current value: that of the command line, or the default.
std::string ConfigFileOf(const CLI::App& command);

}  // namespace thunderhead::app
