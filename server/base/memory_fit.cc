#include "base/memory_fit.h"

#include <sys/resource.h>

#include <algorithm>
#include <limits>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "base/error_details.h"
#include "base/machine_memory.h"

namespace thunderhead::base {
namespace {

// Returns the smaller of the machine's memory and the process's address space limit.
std::size_t MostBytes() {
  // A confined process cannot open the files that report the machine's memory, so only its address
  // space limit applies.
  static const std::size_t machine = base::MachineMemoryBytes();
  const std::size_t most = machine > 0 ? machine : std::numeric_limits<std::size_t>::max();
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return most;
  return std::min<std::size_t>(most, limit.rlim_cur);
}

}  // namespace

absl::StatusOr<std::size_t> CountThatFits(const std::string& what,
                                          const std::vector<std::size_t>& lengths,
                                          std::size_t bytes_each) {
  const std::size_t most = MostBytes();
  double size = static_cast<double>(bytes_each);
  std::size_t count = 1;
  for (const std::size_t length : lengths) {
    size *= static_cast<double>(length);
    count *= length;
  }
  if (size <= static_cast<double>(most)) return count;
  constexpr double kGiB = 1 << 30;
  return base::WithDetails(
      absl::ResourceExhaustedError(
          absl::StrCat(what, " has ", absl::StrJoin(lengths, " x "), " values",
                       absl::StrFormat(" (%.4g GiB), more than the %.4g GiB that can be held here",
                                       size / kGiB, static_cast<double>(most) / kGiB),
                       "; cut a smaller domain")),
      {.permanent = true});
}

}  // namespace thunderhead::base
