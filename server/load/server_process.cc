#include "load/server_process.h"

#include <netdb.h>
#include <sys/socket.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <system_error>
#include <vector>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "load/recording.h"

namespace thunderhead::load {
namespace {

namespace fs = std::filesystem;

// Returns true if `host` is an address of this machine. Only such an address can be bound.
bool IsThisMachine(const std::string& host) {
  addrinfo* found = nullptr;
  addrinfo wanted{};
  wanted.ai_socktype = SOCK_STREAM;
  if (::getaddrinfo(host.c_str(), nullptr, &wanted, &found) != 0) return false;
  bool bound = false;
  for (const addrinfo* at = found; at != nullptr && !bound; at = at->ai_next) {
    const int descriptor = ::socket(at->ai_family, SOCK_STREAM, 0);
    if (descriptor < 0) continue;
    bound = ::bind(descriptor, at->ai_addr, at->ai_addrlen) == 0;
    ::close(descriptor);
  }
  ::freeaddrinfo(found);
  return bound;
}

// Returns the inode of the socket that listens on the port, from /proc/net/tcp or tcp6. In these
// tables, field 2 has the address and port in hexadecimal, field 4 the state, and field 10 the
// inode.
std::optional<std::string> ListeningInode(int port) {
  for (const char* table : {"/proc/net/tcp", "/proc/net/tcp6"}) {
    std::ifstream lines(table);
    for (std::string line; std::getline(lines, line);) {
      const std::vector<std::string> columns = absl::StrSplit(line, ' ', absl::SkipEmpty());
      if (columns.size() < 10 || columns[3] != "0A") continue;
      const std::vector<std::string> local = absl::StrSplit(columns[1], ':');
      int listening = 0;
      if (local.size() == 2 && absl::SimpleHexAtoi(local[1], &listening) && listening == port) {
        return columns[9];
      }
    }
  }
  return std::nullopt;
}

bool HasSocket(const fs::path& process, const std::string& inode) {
  const std::string link = absl::StrCat("socket:[", inode, "]");
  std::error_code error;
  for (fs::directory_iterator file(process / "fd", error), end; !error && file != end;
       file.increment(error)) {
    std::error_code unreadable;
    if (fs::read_symlink(file->path(), unreadable) == link) return true;
  }
  return false;
}

}  // namespace

std::optional<ServerProcess> ServerProcess::Find(const std::string& host, int port) {
  if (!IsThisMachine(host)) return std::nullopt;
  const std::optional<std::string> inode = ListeningInode(port);
  if (!inode.has_value()) return std::nullopt;
  std::error_code error;
  for (fs::directory_iterator process("/proc", error), end; !error && process != end;
       process.increment(error)) {
    int pid = 0;
    if (!absl::SimpleAtoi(process->path().filename().string(), &pid)) continue;
    if (HasSocket(process->path(), *inode)) return ServerProcess(pid);
  }
  return std::nullopt;
}

std::optional<ProcessSample> ServerProcess::Sample() const {
  const std::string process = absl::StrCat("/proc/", pid_);
  std::string stat;
  std::getline(std::ifstream(process + "/stat"), stat);
  // The process name, in parentheses, may contain any characters. The state and the numbers follow
  // it.
  const std::size_t name_end = stat.rfind(')');
  if (name_end == std::string::npos) return std::nullopt;
  const std::vector<std::string> columns =
      absl::StrSplit(stat.substr(name_end + 1), ' ', absl::SkipEmpty());
  constexpr std::size_t kUser = 11;
  constexpr std::size_t kSystem = 12;
  double user_ticks = 0.0;
  double system_ticks = 0.0;
  double pages = 0.0;
  double resident_pages = 0.0;
  if (columns.size() <= kSystem || !absl::SimpleAtod(columns[kUser], &user_ticks) ||
      !absl::SimpleAtod(columns[kSystem], &system_ticks) ||
      !(std::ifstream(process + "/statm") >> pages >> resident_pages)) {
    return std::nullopt;
  }
  return ProcessSample{
      .at_s = Now_s(),
      .cpu_s = (user_ticks + system_ticks) / static_cast<double>(::sysconf(_SC_CLK_TCK)),
      .rss_mb = 1e-6 * resident_pages * static_cast<double>(::sysconf(_SC_PAGESIZE))};
}

}  // namespace thunderhead::load
