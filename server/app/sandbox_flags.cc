#include "app/sandbox_flags.h"

#include <chrono>
#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include "base/status.h"
#include "sandbox/untrusted_files.h"
#include "spdlog/spdlog.h"

namespace thunderhead::app {

void AddSandboxFlags(CLI::App& command, SandboxFlags& flags) {
  command.add_option("--untrusted", flags.untrusted,
                     "Folders whose storm files others can write: a confined process reads them");
  command.add_option(
      "--allow-links-to", flags.allowed_links,
      "Folders that symbolic links in the data folders may lead to; links into the data "
      "folders are always followed, and links in --untrusted folders never");
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

namespace {

sandbox::ReaderLimits LimitsOf(const SandboxFlags& flags) {
  return {.memory_bytes = static_cast<std::uint64_t>(flags.memory_mib) << 20,
          .time = std::chrono::milliseconds(std::lround(1e3 * flags.seconds))};
}

}  // namespace

absl::StatusOr<volume::StormFormats> FormatsOf(const SandboxFlags& flags) {
  volume::StormFormats formats = volume::StormFormats::BuiltIn();
  const bool all = flags.sandbox == "all";
  if (!all && flags.untrusted.empty()) return formats;
  sandbox::UntrustedOptions options;
  options.folders = flags.untrusted;
  options.all = all;
  options.limits = LimitsOf(flags);
  const auto untrusted = std::make_shared<sandbox::UntrustedFiles>(std::move(options));
  THUNDERHEAD_RETURN_IF_ERROR(untrusted->Probe());
  return sandbox::WithUntrusted(std::move(formats), untrusted);
}

std::function<std::shared_ptr<const volume::RecordReader>(const volume::StormFile&)> ReaderApart(
    const SandboxFlags& flags) {
  const auto files = std::make_shared<sandbox::UntrustedFiles>(
      sandbox::UntrustedOptions{.folders = {}, .all = true, .limits = LimitsOf(flags)});
  if (const absl::Status confined = files->Probe(); !confined.ok()) {
    spdlog::info("while a storage hangs, no other will be read: {}",
                 std::string(confined.message()));
    return {};
  }
  return [files](const volume::StormFile& file) { return files->ReaderOf(file); };
}

}  // namespace thunderhead::app
