#include "app/reader_flags.h"

#include <chrono>
#include <cmath>
#include <string>

#include "app/hidden_flags.h"
#include "sandbox/confined_files.h"

namespace thunderhead::app {

void AddReaderFlags(CLI::App& command, ReaderFlags& flags) {
  command
      .add_option("--sandbox-memory", flags.memory_mib,
                  "Maximum MiB of memory for reading one time of a storm file; by default this "
                  "machine's memory")
      ->check(CLI::Range(16.0, 1e9))
      ->capture_default_str();
  command
      .add_option("--sandbox-seconds", flags.seconds,
                  "Maximum seconds for reading one time of a storm file")
      ->check(CLI::Range(1.0, 86400.0))
      ->capture_default_str();
  // An earlier flag that scripts still give. It has no effect, because every storm file is read by
  // a confined process.
  CLI::Option* const sandbox = command.add_option_function<std::string>(
      "--sandbox", [](const std::string& /*files*/) {},
      "Has no effect: every storm file is read by a confined process");
  sandbox->check(CLI::IsMember({"untrusted", "all"}))->configurable(false);
  HideFromHelp(*sandbox);
}

sandbox::ReaderLimits LimitsOf(const ReaderFlags& flags) {
  return {.memory_bytes = static_cast<std::uint64_t>(flags.memory_mib) << 20,
          .time = std::chrono::milliseconds(std::lround(1e3 * flags.seconds)),
          .memory_flag = "--sandbox-memory",
          .time_flag = "--sandbox-seconds"};
}

absl::Status ProbeReaders(const sandbox::ReaderLimits& limits) {
  return sandbox::ConfinedFiles({.limits = limits}).Probe();
}

}  // namespace thunderhead::app
