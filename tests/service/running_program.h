// The program thunderhead in a separate process, which a test may stop at any moment.
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace thunderhead::testing {

// How a process ended: its exit code, or the signal that ended it.
struct Ending {
  int code = -1;   // exit code; -1 if a signal ended the process
  int signal = 0;  // 0 if it exited on its own
};

class RunningProgram {
 public:
  // Starts `program`. Its output is appended to the files `out` and `err`.
  RunningProgram(const std::string& program, const std::vector<std::string>& arguments,
                 const std::string& out, const std::string& err);
  // Kills the process if it still runs.
  ~RunningProgram();
  RunningProgram(const RunningProgram&) = delete;
  RunningProgram& operator=(const RunningProgram&) = delete;

  void Signal(int signal) const;
  // Returns whether the program has treated a first signal as a request to stop, so that a second
  // signal ends it (server/app/interruption.h).
  bool IsInterrupted() const;
  bool Runs();
  Ending Wait();

 private:
  pid_t process_ = -1;  // process id; -1 after the process has ended
  Ending ending_;
};

}  // namespace thunderhead::testing
