// The program as another process, which a test may stop at any moment.
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace thunderhead::testing {

// How a process ended.
struct Ending {
  int code = -1;   // -1 if a signal ended it
  int signal = 0;  // 0 if it ended by itself
};

class RunningProgram {
 public:
  // Starts PROGRAM; its output goes to the files `out` and `err`, behind what is there.
  RunningProgram(const std::string& program, const std::vector<std::string>& arguments,
                 const std::string& out, const std::string& err);
  // Kills it if it still runs.
  ~RunningProgram();
  RunningProgram(const RunningProgram&) = delete;
  RunningProgram& operator=(const RunningProgram&) = delete;

  void Signal(int signal) const;
  // Returns whether the program has taken a first signal as its request to stop, so that a second
  // one ends it (server/app/interruption.h).
  bool IsInterrupted() const;
  bool Runs();
  Ending Wait();

 private:
  pid_t process_ = -1;  // -1 once it has ended
  Ending ending_;
};

}  // namespace thunderhead::testing
