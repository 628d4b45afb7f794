#include "load/web_wire.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_split.h"

namespace thunderhead::load {
namespace {

constexpr std::size_t kHeaderBytes = 5;
constexpr std::uint8_t kTrailerFlag = 0x80;

std::string PercentDecode(const std::string& text) {
  std::string decoded;
  for (std::size_t i = 0; i < text.size(); ++i) {
    std::uint32_t byte = 0;
    if (text[i] == '%' && i + 2 < text.size() &&
        absl::SimpleHexAtoi(text.substr(i + 1, 2), &byte)) {
      decoded.push_back(static_cast<char>(byte));
      i += 2;
    } else {
      decoded.push_back(text[i]);
    }
  }
  return decoded;
}

absl::Status Malformed() {
  return absl::InternalError("the server's answer is not gRPC-Web; is it Thunderhead's HTTP port?");
}

}  // namespace

absl::Status StatusOfTrailers(std::string_view trailers) {
  std::optional<int> code;
  std::string message;
  const std::vector<std::string> lines = absl::StrSplit(std::string(trailers), '\n');
  for (const std::string& line : lines) {
    const std::size_t colon = line.find(':');
    if (colon == std::string::npos) continue;
    const std::string name = line.substr(0, colon);
    const std::string value(absl::StripAsciiWhitespace(line.substr(colon + 1)));
    int parsed = 0;
    if (name == "grpc-status" && absl::SimpleAtoi(value, &parsed)) code = parsed;
    if (name == "grpc-message") message = PercentDecode(value);
  }
  if (!code.has_value()) return Malformed();
  return {static_cast<absl::StatusCode>(*code), message};
}

absl::StatusOr<std::string> UnaryMessage(std::string_view body) {
  std::optional<std::string> message;
  while (body.size() >= kHeaderBytes) {
    const auto flags = static_cast<std::uint8_t>(body[0]);
    std::size_t bytes = 0;
    for (std::size_t i = 1; i < kHeaderBytes; ++i) {
      bytes = bytes << 8 | static_cast<std::uint8_t>(body[i]);
    }
    if (body.size() < kHeaderBytes + bytes) return Malformed();
    const std::string_view payload = body.substr(kHeaderBytes, bytes);
    body.remove_prefix(kHeaderBytes + bytes);
    if ((flags & kTrailerFlag) == 0) {
      message = std::string(payload);
      continue;
    }
    if (const absl::Status status = StatusOfTrailers(payload); !status.ok()) return status;
    if (message.has_value()) return *std::move(message);
  }
  return Malformed();
}

}  // namespace thunderhead::load
