// Tests of what a confined process may no longer do.
#include "sandbox/confinement.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <thread>

namespace thunderhead::sandbox {
namespace {

// Returns errno of an attempt to open a file in the calling thread, or 0 if it opens.
int ErrorOfOpening() { return open("/dev/null", O_RDONLY | O_CLOEXEC) < 0 ? errno : 0; }

TEST(ConfinementTest, ThreadsThatBeganBeforeAreConfinedToo) {
  enum Outcome { kBothConfined, kNotConfinable, kThreadIsFree, kCallerIsFree };
  const pid_t child = fork();
  if (child == 0) {
    std::atomic<bool> confined = false;
    std::atomic<int> error = -1;
    std::thread thread([&] {
      confined.wait(false);
      error = ErrorOfOpening();
    });
    if (!Confine({.memory_bytes = std::uint64_t{256} << 20, .processor_s = 10}).ok()) {
      _exit(kNotConfinable);
    }
    confined = true;
    confined.notify_all();
    thread.join();
    if (error != EPERM) _exit(kThreadIsFree);
    _exit(ErrorOfOpening() == EPERM ? kBothConfined : kCallerIsFree);
  }
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), kBothConfined);
}

}  // namespace
}  // namespace thunderhead::sandbox
