#include "app/sandbox_flags.h"

#include <chrono>
#include <cmath>
#include <memory>

#include "base/status.h"
#include "sandbox/untrusted_files.h"

namespace thunderhead::app {

void AddSandboxFlags(CLI::App& command, SandboxFlags& flags) {
  command.add_option("--untrusted", flags.untrusted,
                     "Folders whose storm files others can write: a confined process reads them");
  command
      .add_option("--sandbox", flags.sandbox,
                  "untrusted, for the files of --untrusted, or all, for every storm file")
      ->check(CLI::IsMember({"untrusted", "all"}))
      ->capture_default_str();
  command
      .add_option("--sandbox-memory", flags.memory_mib,
                  "MiB that reading one time of an untrusted file may take")
      ->check(CLI::Range(16.0, 1e9))
      ->capture_default_str();
  command
      .add_option("--sandbox-seconds", flags.seconds,
                  "Seconds that reading one time of an untrusted file may take")
      ->check(CLI::Range(1.0, 86400.0))
      ->capture_default_str();
}

absl::StatusOr<volume::StormFormats> FormatsOf(const SandboxFlags& flags) {
  volume::StormFormats formats = volume::StormFormats::BuiltIn();
  const bool all = flags.sandbox == "all";
  if (!all && flags.untrusted.empty()) return formats;
  sandbox::UntrustedOptions options;
  options.folders = flags.untrusted;
  options.all = all;
  options.limits.memory_bytes = static_cast<std::uint64_t>(flags.memory_mib) << 20;
  options.limits.time = std::chrono::milliseconds(std::lround(1e3 * flags.seconds));
  const auto untrusted = std::make_shared<sandbox::UntrustedFiles>(std::move(options));
  THUNDERHEAD_RETURN_IF_ERROR(untrusted->Probe());
  return sandbox::WithUntrusted(std::move(formats), untrusted);
}

}  // namespace thunderhead::app
