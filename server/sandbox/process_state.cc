#include "sandbox/process_state.h"

#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"

namespace thunderhead::sandbox {

std::optional<ProcessState> StateOf(pid_t process) {
  std::ifstream file(absl::StrCat("/proc/", process, "/stat"));
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  // The name of the process precedes its state, in parentheses, and may contain any character.
  const std::size_t name_end = text.rfind(')');
  if (name_end == std::string::npos) return std::nullopt;
  std::istringstream rest(text.substr(name_end + 1));
  char state = 0;
  rest >> state;
  // The skipped fields are ppid, pgrp, session, tty_nr, tpgid, flags, minflt and cminflt.
  std::string skipped;
  for (int i = 0; i < 8; ++i) rest >> skipped;
  std::uint64_t major_faults = 0;
  if (!(rest >> major_faults)) return std::nullopt;
  return ProcessState{state == 'D', major_faults};
}

bool StorageWatch::ExplainsSilence() {
  const std::optional<ProcessState> now = StateOf(process_);
  if (!now.has_value()) return false;
  const std::uint64_t before = std::exchange(pages_before_, now->pages_from_storage);
  return now->waits_for_storage || now->pages_from_storage > before;
}

}  // namespace thunderhead::sandbox
