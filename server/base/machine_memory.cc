#include "base/machine_memory.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>
#include <vector>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"

namespace thunderhead::base {
namespace {

constexpr std::uint64_t kUnlimited = std::numeric_limits<std::uint64_t>::max();

// Returns the number at the start of a file, or nothing for "max" and for a missing file.
std::optional<std::uint64_t> NumberIn(const std::string& path) {
  std::ifstream file(path);
  std::string word;
  std::uint64_t number = 0;
  if (!(file >> word) || !absl::SimpleAtoi(word, &number)) return std::nullopt;
  return number;
}

std::uint64_t TotalBytes(const std::string& root) {
  std::ifstream meminfo(root + "/proc/meminfo");
  std::string name;
  std::uint64_t kib = 0;
  while (meminfo >> name >> kib) {
    if (name == "MemTotal:") return kib << 10U;
    meminfo.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
  }
  return kUnlimited;
}

// Returns the lowest limit that the files named `file` contain, in the group's folder and its
// parent folders.
std::uint64_t LeastAlong(const std::string& hierarchy, std::string group, const char* file) {
  std::uint64_t least = kUnlimited;
  while (true) {
    least =
        std::min(least, NumberIn(absl::StrCat(hierarchy, group, "/", file)).value_or(kUnlimited));
    if (group.empty()) return least;
    group.resize(group.rfind('/') == std::string::npos ? 0 : group.rfind('/'));
  }
}

std::uint64_t CgroupBytes(const std::string& root) {
  std::uint64_t least = kUnlimited;
  std::ifstream groups(root + "/proc/self/cgroup");
  for (std::string line; std::getline(groups, line);) {
    // A line holds the hierarchy's number, its controllers and the group's path. Version 2 of
    // cgroups has the number 0 and no controllers.
    const std::vector<std::string> parts = absl::StrSplit(line, absl::MaxSplits(':', 2));
    if (parts.size() != 3) continue;
    const std::string group = parts[2] == "/" ? "" : parts[2];
    if (parts[0] == "0" && parts[1].empty()) {
      least = std::min(least, LeastAlong(root + "/sys/fs/cgroup", group, "memory.max"));
      least = std::min(least, LeastAlong(root + "/sys/fs/cgroup", group, "memory.high"));
    } else if (parts[1] == "memory") {
      least = std::min(least,
                       LeastAlong(root + "/sys/fs/cgroup/memory", group, "memory.limit_in_bytes"));
    }
  }
  return least;
}

}  // namespace

std::size_t MachineMemoryBytes(const std::string& root) {
  const std::uint64_t bytes = std::min(TotalBytes(root), CgroupBytes(root));
  return bytes == kUnlimited ? 0 : static_cast<std::size_t>(bytes);
}

}  // namespace thunderhead::base
