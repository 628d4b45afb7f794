// A pseudo-terminal on which a program shows its progress.
#pragma once

#include <fcntl.h>
#include <unistd.h>

#include <cstddef>
#include <cstdlib>
#include <string>

namespace thunderhead::testing {

// A terminal that is opened as the program's standard error.
class Terminal {
 public:
  Terminal() : master_(posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK)) {
    grantpt(master_);
    unlockpt(master_);
    name_ = ptsname(master_);
    // Holds the slave side open, so that the output is kept after the program has ended.
    slave_ = open(name_.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
  }
  ~Terminal() {
    close(slave_);
    close(master_);
  }
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  const std::string& Name() const { return name_; }
  // Returns everything that the terminal has shown until now.
  const std::string& Shown() {
    char part[4096];
    for (ssize_t got = 0; (got = read(master_, part, sizeof(part))) > 0;) {
      shown_.append(part, static_cast<std::size_t>(got));
    }
    return shown_;
  }

 private:
  const int master_;
  int slave_ = -1;
  std::string name_;
  std::string shown_;
};

}  // namespace thunderhead::testing
