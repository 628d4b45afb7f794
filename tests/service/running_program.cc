#include "tests/service/running_program.h"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>

#include "absl/strings/str_cat.h"
#include "base/status.h"

namespace thunderhead::testing {
namespace {

Ending EndingOf(int status) {
  Ending ending;
  if (WIFEXITED(status)) ending.code = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) ending.signal = WTERMSIG(status);
  return ending;
}

}  // namespace

RunningProgram::RunningProgram(const std::string& program,
                               const std::vector<std::string>& arguments, const std::string& out,
                               const std::string& err) {
  std::vector<char*> argv = {const_cast<char*>(program.c_str())};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  process_ = fork();
  THUNDERHEAD_CHECK(process_ >= 0, "no process");
  if (process_ > 0) return;
  constexpr int kAppend = O_WRONLY | O_CREAT | O_APPEND;
  dup2(open(out.c_str(), kAppend, 0600), STDOUT_FILENO);
  dup2(open(err.c_str(), kAppend, 0600), STDERR_FILENO);
  execv(program.c_str(), argv.data());
  _exit(127);
}

RunningProgram::~RunningProgram() {
  if (process_ < 0) return;
  Signal(SIGKILL);
  Wait();
}

void RunningProgram::Signal(int signal) const {
  if (process_ >= 0) kill(process_, signal);
}

bool RunningProgram::IsInterrupted() const {
  if (process_ < 0) return false;
  std::error_code ended;
  for (const auto& thread :
       std::filesystem::directory_iterator(absl::StrCat("/proc/", process_, "/task"), ended)) {
    std::string name;
    if (std::getline(std::ifstream(thread.path() / "comm"), name) && name == "interrupted") {
      return true;
    }
  }
  return false;
}

bool RunningProgram::Runs() {
  int status = 0;
  if (process_ >= 0 && waitpid(process_, &status, WNOHANG) == process_) {
    ending_ = EndingOf(status);
    process_ = -1;
  }
  return process_ >= 0;
}

Ending RunningProgram::Wait() {
  int status = 0;
  if (process_ >= 0 && waitpid(process_, &status, 0) == process_) {
    ending_ = EndingOf(status);
    process_ = -1;
  }
  return ending_;
}

}  // namespace thunderhead::testing
