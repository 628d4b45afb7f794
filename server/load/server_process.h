// The processor time and the memory of a server process on this machine. The process is found by
// its listening port. This class reads /proc, so it works only on Linux.
#pragma once

#include <optional>
#include <string>

namespace thunderhead::load {

struct ProcessSample {
  double at_s = 0.0;   // time in seconds on the clock of Now_s()
  double cpu_s = 0.0;  // processor time since the process began
  double rss_mb = 0.0;
};

class ServerProcess {
 public:
  // Returns nothing if `host` is not this machine, or if no process that may be inspected listens
  // on `port`.
  static std::optional<ServerProcess> Find(const std::string& host, int port);

  // Returns nothing once the process has ended.
  std::optional<ProcessSample> Sample() const;
  int pid() const { return pid_; }

 private:
  explicit ServerProcess(int pid) : pid_(pid) {}

  int pid_;
};

}  // namespace thunderhead::load
