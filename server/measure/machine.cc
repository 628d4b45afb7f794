#include "measure/machine.h"

#include <fstream>
#include <thread>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace thunderhead::measure {
namespace {

std::string ProcessorName() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    const std::size_t colon = line.find(':');
    if (!absl::StartsWith(line, "model name") || colon == std::string::npos) continue;
    return std::string(absl::StripAsciiWhitespace(line.substr(colon + 1)));
  }
  return "unknown";
}

}  // namespace

Machine MachineOf(const gl::ContextInfo& context) {
  return {ProcessorName(), static_cast<int>(std::thread::hardware_concurrency()), context.device,
          context.renderer, context.version};
}

std::string JsonText(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      absl::StrAppend(&quoted, "\\", std::string(1, c));
    } else if (static_cast<unsigned char>(c) < 0x20) {
      absl::StrAppendFormat(&quoted, "\\u%04x", static_cast<unsigned>(c));
    } else {
      quoted += c;
    }
  }
  return quoted + "\"";
}

std::string ToJson(const Machine& machine) {
  return absl::StrFormat(
      "{\"processor\": %s, \"threads\": %d, \"device\": %s, \"gl_renderer\": %s, "
      "\"gl_version\": %s}",
      JsonText(machine.processor), machine.threads, JsonText(machine.device),
      JsonText(machine.gl_renderer), JsonText(machine.gl_version));
}

}  // namespace thunderhead::measure
