// Checks of all values on the command line and in settings files.
#pragma once

#include "CLI/CLI.hpp"

namespace thunderhead::app {

// Lets each option of the command and of its subcommands refuse values that CLI11 alone would
// accept or misread:
// - For a decimal number: "nan" and "inf". Checks of a range would accept "nan", because it is
//   neither below the minimum nor above the maximum.
// - For an integer: all but decimal digits. CLI11 reads "010" as 8, and
//   "99999999999999999999" as the largest number of 64 bits.
// - For a flag without a value: all but "true" and "false", which it has in a settings file. CLI11
//   reads "2" as true.
void RefuseWrongValues(CLI::App& command);

}  // namespace thunderhead::app
