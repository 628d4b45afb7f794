#include "app/seed_flag.h"

namespace thunderhead::app {

void AddSeedFlag(CLI::App& command, const std::string& description, std::uint64_t* seed) {
  command.add_option("--seed", *seed, description)
      ->capture_default_str()
      ->check([](const std::string& text) {
        return text.starts_with('-') ? "it is " + text + "; it must be 0 or more" : std::string();
      });
}

}  // namespace thunderhead::app
