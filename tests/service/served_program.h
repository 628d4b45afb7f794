// The program thunderhead as a server in a separate process, which a test may kill.
#pragma once

#include <sys/types.h>

#include <memory>
#include <string>
#include <vector>

#include "thunderhead/v1/thunderhead.grpc.pb.h"

namespace thunderhead::testing {

class ServedProgram {
 public:
  // Starts `thunderhead serve` for the storm, on free ports, with the software renderer and the
  // flags in `more`. Waits until the server is ready.
  ServedProgram(const std::string& program, const std::string& storm, const std::string& state,
                const std::vector<std::string>& more = {});
  // Kills the process with SIGKILL.
  ~ServedProgram();
  ServedProgram(const ServedProgram&) = delete;
  ServedProgram& operator=(const ServedProgram&) = delete;

  // Returns the stub for calls to the server; null if the program did not start.
  v1::ThunderheadService::Stub* stub() { return stub_.get(); }

  pid_t process() const { return process_; }

  // Sends the signal and waits for the process to end.
  void End(int signal);

 private:
  pid_t process_ = -1;  // process id; -1 after the process has ended
  std::unique_ptr<v1::ThunderheadService::Stub> stub_;
};

}  // namespace thunderhead::testing
