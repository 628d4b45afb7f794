#include "app/audit_log.h"

#include <fcntl.h>
#include <sys/stat.h>

#include <cerrno>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>

#include "absl/strings/str_cat.h"
#include "app/log_format.h"
#include "base/file_descriptor.h"
#include "base/line_writer.h"
#include "base/status.h"
#include "spdlog/sinks/basic_file_sink.h"
#include "spdlog/sinks/stdout_sinks.h"
#include "spdlog/spdlog.h"

namespace thunderhead::app {
namespace {

// Maximum number of lines that wait to be written while the disk hangs.
constexpr std::size_t kMaxWaitingLines = 10'000;

// Creates the file, because spdlog creates files that every user may read. Anything but a regular
// file is refused: a FIFO without a reader would block, and a device could lose the entries.
absl::Status Create(const std::string& path) {
  const auto refused = [&](const std::string& why) {
    return absl::InvalidArgumentError(absl::StrCat("cannot write --audit-log ", path, ": ", why));
  };
  const base::FileDescriptor file(::open(
      path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_NONBLOCK | O_NOCTTY | O_CLOEXEC, 0600));
  struct stat about {};
  // The error ENXIO means that the path is a FIFO, a socket or a device that does not exist. Such a
  // path gets the message below.
  if (!file.IsOpen() && errno != ENXIO) return refused(strerror(errno));
  if (file.IsOpen() && fstat(file.Get(), &about) == 0 && S_ISREG(about.st_mode)) {
    return absl::OkStatus();
  }
  return refused(
      "it is not a regular file; name a file, or leave the flag out to write to standard error");
}

}  // namespace

absl::StatusOr<std::shared_ptr<access::Audit>> OpenAudit(const std::string& path,
                                                         const std::string& log_format) {
  spdlog::sink_ptr sink;
  if (path.empty()) {
    sink = std::make_shared<spdlog::sinks::stderr_sink_mt>();
  } else {
    THUNDERHEAD_RETURN_IF_ERROR(Create(path));
    sink = std::make_shared<spdlog::sinks::basic_file_sink_mt>(path);
  }
  const auto log = std::make_shared<spdlog::logger>("audit", std::move(sink));
  if (path.empty() && log_format == "json") {
    log->set_formatter(std::make_unique<JsonFormatter>());
  } else {
    log->set_pattern("%v");  // only the message, which contains its own time
  }
  log->flush_on(spdlog::level::info);
  const auto writer = std::make_shared<base::LineWriter>(
      kMaxWaitingLines, [log](const std::string& line, std::uint64_t left_out) {
        const std::string lost = left_out > 0 ? absl::StrCat(" unwritten=", left_out) : "";
        const char* const text = line.empty() ? "audit" : line.c_str();
        log->log(spdlog::level::info, spdlog::string_view_t(absl::StrCat(text, lost)));
      });
  return std::make_shared<access::Audit>(
      [writer](const std::string& line) { writer->Write(line); },
      [writer](std::chrono::milliseconds time) { (void)writer->Flush(time); });
}

}  // namespace thunderhead::app
