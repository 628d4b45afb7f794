// The processor time and the memory of a server on this machine, found by the port it listens on.
// Linux only: reads /proc.
#pragma once

#include <optional>
#include <string>

namespace thunderhead::load {

struct ProcessSample {
  double at_s = 0.0;   // as Now_s()
  double cpu_s = 0.0;  // processor time since the process began
  double rss_mb = 0.0;
};

class ServerProcess {
 public:
  // None if `host` is not this machine, or no process that may be looked at listens there.
  static std::optional<ServerProcess> Find(const std::string& host, int port);

  // None once the process is gone.
  std::optional<ProcessSample> Sample() const;
  int pid() const { return pid_; }

 private:
  explicit ServerProcess(int pid) : pid_(pid) {}

  int pid_;
};

}  // namespace thunderhead::load
