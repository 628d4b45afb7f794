// A check of all numbers on the command line.
#pragma once

#include "CLI/CLI.hpp"

namespace thunderhead::app {

// Lets each option of the command and of its subcommands that takes a decimal number refuse "nan"
// and "inf". CLI11's own limits accept "nan", because it is neither too small nor too large.
void RefuseInfiniteNumbers(CLI::App& command);

}  // namespace thunderhead::app
