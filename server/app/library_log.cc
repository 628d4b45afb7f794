#include "app/library_log.h"

#include <chrono>
#include <mutex>
#include <string>

#include "absl/strings/str_cat.h"
#include "base/line_limit.h"
#include "google/protobuf/stubs/logging.h"
#include "grpc/support/log.h"
#include "spdlog/spdlog.h"

namespace thunderhead::app {
namespace {

constexpr int kMaxLinesPerSecond = 10;

void Tell(spdlog::level::level_enum level, const std::string& text) {
  static std::mutex mutex;
  static base::LineLimit limit(kMaxLinesPerSecond);
  const std::lock_guard lock(mutex);
  const auto left_out = limit.Take(std::chrono::system_clock::now());
  if (!left_out.has_value()) return;
  const std::string others = *left_out > 0 ? absl::StrCat(" (", *left_out, " left out)") : "";
  spdlog::log(level, "{}{}", text, others);
}

void TellOfGrpc(gpr_log_func_args* line) {
  Tell(line->severity == GPR_LOG_SEVERITY_ERROR ? spdlog::level::warn : spdlog::level::debug,
       absl::StrCat("gRPC: ", line->message));
}

void TellOfProtobuf(google::protobuf::LogLevel level, const char* /*file*/, int /*line*/,
                    const std::string& message) {
  Tell(level == google::protobuf::LOGLEVEL_INFO ? spdlog::level::debug : spdlog::level::warn,
       absl::StrCat("protobuf: ", message));
}

}  // namespace

void TakeLibraryLogs() {
  gpr_set_log_function(&TellOfGrpc);
  google::protobuf::SetLogHandler(&TellOfProtobuf);
}

}  // namespace thunderhead::app
