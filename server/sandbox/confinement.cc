#include "sandbox/confinement.h"

#include <malloc.h>
#include <sched.h>
#include <seccomp.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

#include "absl/strings/str_cat.h"
#include "base/status.h"

namespace thunderhead::sandbox {
namespace {

absl::Status Impossible(const char* what, int error) {
  return absl::FailedPreconditionError(absl::StrCat(
      "storm files cannot be read safely here: ", what, " fails (", std::strerror(error),
      "); allow the program seccomp (a container's security profile may forbid it)"));
}

std::uint64_t AddressSpace() {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> statm(std::fopen("/proc/self/statm", "re"),
                                                              std::fclose);
  unsigned long long pages = 0;
  if (statm == nullptr || std::fscanf(statm.get(), "%llu", &pages) != 1) return 0;
  return pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

absl::Status Limit(__rlimit_resource resource, rlim_t soft, rlim_t hard) {
  rlimit limit{};
  if (getrlimit(resource, &limit) != 0) return Impossible("getrlimit", errno);
  // A limit that is already lower stays.
  limit.rlim_max = std::min(limit.rlim_max, hard);
  limit.rlim_cur = std::min(limit.rlim_max, soft);
  if (setrlimit(resource, &limit) != 0) return Impossible("setrlimit", errno);
  return absl::OkStatus();
}

// Allows the system calls for memory, threads, waiting, open pipes, the clock and exit. Some calls
// are allowed only with certain arguments. Memory must not be executable, clone may only start
// threads, signals may only go to the process itself, and limits may only be read.
int AllowReading(scmp_filter_ctx filter) {
  // A condition on one argument of a call: its index, the comparison, and the values.
  using Argument = scmp_arg_cmp;
  const auto allow = [filter](int call, auto... conditions) {
    return seccomp_rule_add(filter, SCMP_ACT_ALLOW, call, sizeof...(conditions), conditions...);
  };
  const auto self = static_cast<scmp_datum_t>(getpid());
  int error = 0;
  for (const int call : {SCMP_SYS(read),
                         SCMP_SYS(write),
                         SCMP_SYS(poll),
                         SCMP_SYS(ppoll),
                         SCMP_SYS(close),
                         SCMP_SYS(fstat),
                         SCMP_SYS(munmap),
                         SCMP_SYS(mremap),
                         SCMP_SYS(madvise),
                         SCMP_SYS(brk),
                         SCMP_SYS(futex),
                         SCMP_SYS(sched_yield),
                         SCMP_SYS(sched_getaffinity),
                         SCMP_SYS(set_robust_list),
                         SCMP_SYS(rseq),
                         SCMP_SYS(exit),
                         SCMP_SYS(exit_group),
                         SCMP_SYS(clock_gettime),
                         SCMP_SYS(clock_nanosleep),
                         SCMP_SYS(nanosleep),
                         SCMP_SYS(gettimeofday),
                         SCMP_SYS(getrandom),
                         SCMP_SYS(rt_sigaction),
                         SCMP_SYS(rt_sigprocmask),
                         SCMP_SYS(rt_sigreturn),
                         SCMP_SYS(sigaltstack),
                         SCMP_SYS(gettid),
                         SCMP_SYS(getpid),
                         SCMP_SYS(sysinfo),
                         SCMP_SYS(getrusage),
                         SCMP_SYS(restart_syscall)}) {
    if (error == 0) error = allow(call);
  }
  if (error == 0) error = allow(SCMP_SYS(mmap), Argument{2, SCMP_CMP_MASKED_EQ, PROT_EXEC, 0});
  if (error == 0) error = allow(SCMP_SYS(mprotect), Argument{2, SCMP_CMP_MASKED_EQ, PROT_EXEC, 0});
  if (error == 0) {
    error = allow(SCMP_SYS(clone), Argument{0, SCMP_CMP_MASKED_EQ, CLONE_THREAD, CLONE_THREAD});
  }
  if (error == 0) error = allow(SCMP_SYS(tgkill), Argument{0, SCMP_CMP_EQ, self});
  if (error == 0) error = allow(SCMP_SYS(prlimit64), Argument{2, SCMP_CMP_EQ, 0});
  // After ENOSYS for clone3, the C library calls clone instead, whose flags the filter can check.
  if (error == 0) {
    error = seccomp_rule_add(filter, SCMP_ACT_ERRNO(ENOSYS), SCMP_SYS(clone3), 0);
  }
  return error;
}

// Installs the filter. A call that is not allowed fails with EPERM, which libraries report as an
// error. It does not end the process, because another version of the C library may try a call and
// continue without it.
absl::Status FilterCalls() {
  const std::unique_ptr<void, void (*)(scmp_filter_ctx)> filter(seccomp_init(SCMP_ACT_ERRNO(EPERM)),
                                                                seccomp_release);
  if (filter == nullptr) return Impossible("seccomp_init", ENOMEM);
  // Libraries may have started threads while they were loaded. The filter must hold for them, too.
  if (const int error = seccomp_attr_set(filter.get(), SCMP_FLTATR_CTL_TSYNC, 1); error != 0) {
    return Impossible("seccomp_attr_set", -error);
  }
  if (const int error = AllowReading(filter.get()); error != 0) {
    return Impossible("seccomp_rule_add", -error);
  }
  if (const int error = seccomp_load(filter.get()); error != 0) {
    return Impossible("seccomp_load", -error);
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status Confine(const Allowance& allowance) {
  // With more arenas, each thread's arena would take 64 MiB of address space.
  mallopt(M_ARENA_MAX, 1);
  const rlim_t memory = AddressSpace() + allowance.memory_bytes;
  THUNDERHEAD_RETURN_IF_ERROR(Limit(RLIMIT_AS, memory, memory));
  // At the soft limit the process is ended by SIGXCPU, which identifies the cause. The hard limit
  // would end it by SIGKILL.
  THUNDERHEAD_RETURN_IF_ERROR(
      Limit(RLIMIT_CPU, allowance.processor_s, rlim_t{allowance.processor_s} + 1));
  THUNDERHEAD_RETURN_IF_ERROR(Limit(RLIMIT_CORE, 0, 0));
  THUNDERHEAD_RETURN_IF_ERROR(Limit(RLIMIT_FSIZE, 0, 0));
  // With this limit no new descriptor can be opened, because only descriptor 0 would be allowed and
  // it is in use. The limit is not 0, because poll accepts at most as many descriptors as this
  // limit.
  THUNDERHEAD_RETURN_IF_ERROR(Limit(RLIMIT_NOFILE, 1, 1));
  if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) return Impossible("no_new_privs", errno);
  prctl(PR_SET_DUMPABLE, 0, 0, 0, 0);
  return FilterCalls();
}

}  // namespace thunderhead::sandbox
