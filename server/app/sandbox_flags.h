// Which storm files are read by a confined process, as flags.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "CLI/CLI.hpp"
#include "absl/status/statusor.h"
#include "volume/storm_file.h"
#include "volume/storm_format.h"

namespace thunderhead::app {

struct SandboxFlags {
  std::vector<std::string> untrusted;
  std::vector<std::string> allowed_links;
  std::string sandbox = "untrusted";
  double memory_mib = 4096.0;
  double seconds = 120.0;
};

void AddSandboxFlags(CLI::App& command, SandboxFlags& flags);

// The formats of this build, with untrusted files left to confined readers. FAILED_PRECONDITION if
// there are to be some and this machine cannot confine them.
absl::StatusOr<volume::StormFormats> FormatsOf(const SandboxFlags& flags);

// For StormStoreOptions::reader_apart: confined readers of any file. Empty if this machine cannot
// confine them.
std::function<std::shared_ptr<const volume::RecordReader>(const volume::StormFile&)> ReaderApart(
    const SandboxFlags& flags);

}  // namespace thunderhead::app
