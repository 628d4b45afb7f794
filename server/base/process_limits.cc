#include "base/process_limits.h"

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"

namespace thunderhead::base {
namespace {

constexpr rlim_t kMiB = rlim_t{1} << 20;
// The smallest address space in which a server starts. With software rendering on two cores, it
// does not start in 1.4 GiB. It starts in 2 GiB, of which it uses 450 MiB. Most of the rest is
// reserved for the stacks and the memory pools of threads.
constexpr rlim_t kLeast_bytes = 2048 * kMiB;

rlim_t SoftLimit(__rlimit_resource resource) {
  rlimit limit{};
  return getrlimit(resource, &limit) == 0 ? limit.rlim_cur : RLIM_INFINITY;
}

std::string AddressSpace(rlim_t bytes) {
  return absl::StrCat("an address space of ", bytes / kMiB, " MiB (RLIMIT_AS, ulimit -v)");
}

std::string Data(rlim_t bytes) {
  return absl::StrCat("data of ", bytes / kMiB, " MiB (RLIMIT_DATA, ulimit -d)");
}

absl::Status TooSmall(const std::string& limit) {
  return absl::FailedPreconditionError(absl::StrCat(
      "this process is limited to ", limit, ", and a server needs at least ", kLeast_bytes / kMiB,
      " MiB of it, although it uses less memory; raise or remove this limit, and limit memory by ",
      "--memory-budget or by the service manager (MemoryMax= of systemd)"));
}

// The text is made before an exception ends the process, because there may be no memory then.
std::string& KnownLimits() {
  static std::string text;
  return text;
}

[[noreturn]] void EndWith(const char* what) {
  const std::string& limits = KnownLimits();
  std::fprintf(stderr, "thunderhead: ended by an exception that no code could handle (%s)%s%s\n",
               what, limits.empty() ? "" : "; ", limits.c_str());
  std::abort();
}

[[noreturn]] void EndWithLimits() {
  if (std::current_exception() == nullptr) EndWith("none");
  try {
    throw;
  } catch (const std::exception& error) {
    EndWith(error.what());
  } catch (...) {
    EndWith("of an unknown type");
  }
}

}  // namespace

ProcessLimits ReadProcessLimits() {
  return {.address_space_bytes = SoftLimit(RLIMIT_AS),
          .data_bytes = SoftLimit(RLIMIT_DATA),
          .threads = SoftLimit(RLIMIT_NPROC)};
}

std::string TextOf(const ProcessLimits& limits) {
  std::vector<std::string> texts;
  if (limits.address_space_bytes != RLIM_INFINITY) {
    texts.push_back(AddressSpace(limits.address_space_bytes));
  }
  if (limits.data_bytes != RLIM_INFINITY) texts.push_back(Data(limits.data_bytes));
  if (limits.threads != RLIM_INFINITY) {
    texts.push_back(absl::StrCat(limits.threads,
                                 " processes and threads of its user (RLIMIT_NPROC, ulimit -u)"));
  }
  if (texts.empty()) return "";
  return absl::StrCat("the limits of this process are ", absl::StrJoin(texts, ", "));
}

absl::Status CheckProcessLimits(const ProcessLimits& limits) {
  if (limits.address_space_bytes < kLeast_bytes) {
    return TooSmall(AddressSpace(limits.address_space_bytes));
  }
  if (limits.data_bytes < kLeast_bytes) return TooSmall(Data(limits.data_bytes));
  return absl::OkStatus();
}

void TellLimitsAtUnhandledExceptions() {
  KnownLimits() = TextOf(ReadProcessLimits());
  std::set_terminate(&EndWithLimits);
}

}  // namespace thunderhead::base
