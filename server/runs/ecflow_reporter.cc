#include "runs/ecflow_reporter.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <vector>

#include "absl/strings/str_cat.h"

extern char** environ;

namespace thunderhead::runs {
namespace {

// Runs ecflow_client and waits for it; ecflow_client itself stops after ECF_TIMEOUT seconds.
// Returns 0 if it succeeded.
int Spawn(std::vector<std::string> arguments) {
  std::vector<char*> argv;
  argv.reserve(arguments.size() + 1);
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  // Standard output is reserved for the lines of products.
  posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);
  // The signals that this program blocks are unblocked for ecflow_client.
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none;
  sigemptyset(&none);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
  pid_t process = -1;
  const int error =
      posix_spawnp(&process, argv.front(), &actions, &attributes, argv.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) return error;
  int status = 0;
  while (waitpid(process, &status, 0) < 0) {
    if (errno != EINTR) return errno;
  }
  return status;
}

}  // namespace

EcflowReporter::EcflowReporter() : thread_([this] { Run(); }) {}

EcflowReporter::~EcflowReporter() {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

bool EcflowReporter::InTask() { return std::getenv("ECF_NAME") != nullptr; }

void EcflowReporter::Tell(int done, int planned, const std::string& product) {
  {
    const std::lock_guard lock(mutex_);
    newest_ = {planned == 0 ? 0 : std::clamp(100 * done / planned, 0, 100), product};
  }
  changed_.notify_all();
}

void EcflowReporter::Run() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return ended_ || newest_ != told_; });
    if (newest_ == told_) return;
    const State state = newest_;
    lock.unlock();
    TellServer(state);
    lock.lock();
  }
}

void EcflowReporter::TellServer(const State& state) {
  const bool first = told_.product.empty() && !state.product.empty();
  if (state.product != told_.product) Call("--label=product", state.product);
  if (first) Call("--event=first");
  // The meter is set last, so that an observer who sees 100 has also seen the label and the event.
  if (state.percent != told_.percent) Call("--meter=products", absl::StrCat(state.percent));
  told_ = state;
}

void EcflowReporter::Call(const std::string& argument, const std::string& value) {
  std::vector<std::string> arguments = {"ecflow_client", argument};
  if (!value.empty()) arguments.push_back(value);
  if (Spawn(std::move(arguments)) == 0 || complained_) return;
  complained_ = true;
  std::cerr << "thunderhead: the progress is not reported to ecFlow, because ecflow_client "
            << argument << " failed; the pictures are made nevertheless" << std::endl;
}

}  // namespace thunderhead::runs
