// Flags that the help omits.
#pragma once

#include <memory>

#include "CLI/CLI.hpp"

namespace thunderhead::app {

// Omits the option from the help of its command. The help must be written by HelpFormatter().
// CLI11's own way of hiding an option, an empty group, also removes the name from error messages.
void HideFromHelp(CLI::Option& option);

// Returns the formatter of help texts. Of an option with several long names it shows only the first
// name, because the others are earlier names that are still accepted.
std::shared_ptr<CLI::Formatter> HelpFormatter();

}  // namespace thunderhead::app
