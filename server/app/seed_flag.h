// The flag --seed, a non-negative integer. CLI11 alone would convert a negative number to a large
// one.
#pragma once

#include <cstdint>
#include <string>

#include "CLI/CLI.hpp"

namespace thunderhead::app {

void AddSeedFlag(CLI::App& command, const std::string& description, std::uint64_t* seed);

}  // namespace thunderhead::app
