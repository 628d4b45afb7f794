// The flag --seed: a whole number from 0. What reads numbers would take a negative one for a large
// one.
#pragma once

#include <cstdint>
#include <string>

#include "CLI/CLI.hpp"

namespace thunderhead::app {

void AddSeedFlag(CLI::App& command, const std::string& description, std::uint64_t* seed);

}  // namespace thunderhead::app
