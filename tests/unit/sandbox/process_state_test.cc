#include "sandbox/process_state.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

namespace thunderhead::sandbox {
namespace {

TEST(ProcessStateTest, AProcessThatRunsDoesNotWaitForItsStorage) {
  const auto state = StateOf(getpid());
  ASSERT_TRUE(state.has_value());
  EXPECT_FALSE(state->waits_for_storage);
}

TEST(ProcessStateTest, AProcessThatIsNotThereHasNoState) {
  const pid_t child = fork();
  if (child == 0) _exit(0);
  ASSERT_EQ(waitpid(child, nullptr, 0), child);
  EXPECT_FALSE(StateOf(child).has_value());
  EXPECT_FALSE(StorageWatch(child).ExplainsSilence());
}

TEST(ProcessStateTest, TheStorageDoesNotExplainTheSilenceOfAStoppedProcess) {
  const pid_t child = fork();
  if (child == 0) {
    for (;;) pause();
  }
  ASSERT_EQ(kill(child, SIGSTOP), 0);
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, WUNTRACED), child);
  StorageWatch watch(child);
  watch.ExplainsSilence();  // the first call counts earlier page faults
  EXPECT_FALSE(watch.ExplainsSilence());
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
}

}  // namespace
}  // namespace thunderhead::sandbox
