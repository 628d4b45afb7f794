#include "gateway/grpc_web_protocol.h"

#include <grpc/grpc.h>
#include <grpc/slice.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "base/digits.h"
#include "base/status.h"

namespace thunderhead::gateway {
namespace {

constexpr uint8_t kCompressedFlag = 0x01;
constexpr uint8_t kTrailerFlag = 0x80;

// Converts to Abseil's string view. Debian's Abseil has its own type for it.
absl::string_view Absl(std::string_view text) { return {text.data(), text.size()}; }

std::array<uint8_t, kFrameHeaderBytes> FrameHeader(uint8_t flags, uint32_t size) {
  return {flags, static_cast<uint8_t>(size >> 24), static_cast<uint8_t>(size >> 16),
          static_cast<uint8_t>(size >> 8), static_cast<uint8_t>(size)};
}

uint32_t FrameSize(std::string_view frame) {
  uint32_t size = 0;
  for (size_t i = 1; i < kFrameHeaderBytes; ++i) size = size << 8 | static_cast<uint8_t>(frame[i]);
  return size;
}

// Returns the media type without parameters and in lower case: "application/grpc-web+proto" for
// "Application/gRPC-Web+proto; charset=utf-8".
std::string MediaType(std::string_view content_type) {
  const absl::string_view type = Absl(content_type.substr(0, content_type.find(';')));
  return absl::AsciiStrToLower(absl::StripAsciiWhitespace(type));
}

// The following functions ask gRPC itself which metadata it accepts, because it aborts the process
// on metadata that breaks its rules. It also has undocumented exceptions; for example, "-bin" alone
// is not the name of binary metadata.
grpc_slice Borrowed(std::string_view text) {
  return grpc_slice_from_static_buffer(text.data(), text.size());
}
bool IsBinaryName(std::string_view name) { return grpc_is_binary_header(Borrowed(name)) != 0; }
bool IsLegalName(std::string_view name) { return grpc_header_key_is_legal(Borrowed(name)) != 0; }
bool IsLegalText(std::string_view value) {
  return grpc_header_nonbin_value_is_legal(Borrowed(value)) != 0;
}

// Returns true for headers that belong to HTTP or to the browser. Cookies are among them, because a
// browser shares cookies between all ports of a host. It would also send the cookies of other
// programs on localhost.
bool IsNotMetadata(std::string_view name) {
  static constexpr std::string_view kNames[] = {"accept",
                                                "cache-control",
                                                "connection",
                                                "content-encoding",
                                                "content-length",
                                                "content-type",
                                                "cookie",
                                                "dnt",
                                                "expect",
                                                "host",
                                                "http2-settings",
                                                "keep-alive",
                                                "pragma",
                                                "priority",
                                                "proxy-authorization",
                                                "proxy-connection",
                                                "referer",
                                                "te",
                                                "trailer",
                                                "transfer-encoding",
                                                "upgrade",
                                                "upgrade-insecure-requests",
                                                "user-agent",
                                                "x-forwarded-for",
                                                "x-grpc-web",
                                                "x-user-agent"};
  if (name.starts_with("grpc-") || name.starts_with("sec-") || name.starts_with("accept-") ||
      name.starts_with("access-control-")) {
    return true;
  }
  return std::find(std::begin(kNames), std::end(kNames), name) != std::end(kNames);
}

}  // namespace

bool IsBinaryGrpcWeb(std::string_view content_type) {
  const std::string type = MediaType(content_type);
  return type == "application/grpc-web" || type == "application/grpc-web+proto";
}

bool IsMethodPath(std::string_view path) {
  const size_t slash = path.find('/', 1);
  if (!path.starts_with('/') || slash == std::string_view::npos || slash == 1) return false;
  const auto is_name = [](std::string_view text) {
    return !text.empty() && std::all_of(text.begin(), text.end(), [](unsigned char c) {
      return absl::ascii_isalnum(c) || c == '_' || c == '.';
    });
  };
  return is_name(path.substr(1, slash - 1)) && is_name(path.substr(slash + 1));
}

absl::StatusOr<std::string_view> TakeSingleMessage(std::string_view body) {
  if (body.size() < kFrameHeaderBytes) {
    return absl::InvalidArgumentError(
        absl::StrCat("the request body has ", body.size(),
                     " bytes, fewer than the 5 of a gRPC-Web frame's header; send one message"));
  }
  const auto flags = static_cast<uint8_t>(body[0]);
  if (flags == kCompressedFlag) {
    return absl::UnimplementedError(
        "the request message is compressed; send it uncompressed (grpc-encoding: identity)");
  }
  if (flags != 0) {
    return absl::InvalidArgumentError(
        absl::StrCat("the request body begins with frame flags 0x", absl::Hex(flags),
                     "; only uncompressed messages (0x0) are supported"));
  }
  const uint32_t size = FrameSize(body);
  const size_t held = body.size() - kFrameHeaderBytes;
  if (size > held) {
    return absl::InvalidArgumentError(absl::StrCat("the request's frame announces ", size,
                                                   " bytes of message but ", held, " follow"));
  }
  if (size < held) {
    return absl::InvalidArgumentError(
        absl::StrCat("the request body has ", held - size,
                     " bytes after its first message; gRPC-Web sends one message per call"));
  }
  return body.substr(kFrameHeaderBytes);
}

std::array<uint8_t, kFrameHeaderBytes> MessageFrameHeader(uint32_t size) {
  return FrameHeader(0, size);
}

std::string TrailerBlock(const Metadata& trailers) {
  std::string lines;
  for (const auto& [name, value] : trailers) absl::StrAppend(&lines, name, ":", value, "\r\n");
  return lines;
}

std::string TrailerFrame(const Metadata& trailers) {
  const std::string lines = TrailerBlock(trailers);
  const auto header = FrameHeader(kTrailerFlag, static_cast<uint32_t>(lines.size()));
  return std::string(header.begin(), header.end()) + lines;
}

Metadata Trailers(absl::StatusCode code, std::string_view message, const Metadata& metadata) {
  Metadata trailers = {{"grpc-status", absl::StrCat(static_cast<int>(code))}};
  if (!message.empty()) trailers.emplace_back("grpc-message", PercentEncode(message));
  trailers.insert(trailers.end(), metadata.begin(), metadata.end());
  return trailers;
}

std::string PercentEncode(std::string_view message) {
  static constexpr char kHexDigits[] = "0123456789ABCDEF";
  std::string encoded;
  encoded.reserve(message.size());
  for (const char c : message) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 0x20 && byte <= 0x7e && c != '%') {
      encoded += c;
    } else {
      encoded += {'%', kHexDigits[byte >> 4], kHexDigits[byte & 0xf]};
    }
  }
  return encoded;
}

absl::StatusOr<absl::Duration> ParseTimeout(std::string_view text) {
  const auto malformed = [&] {
    return absl::InvalidArgumentError(absl::StrCat(
        "grpc-timeout '", Absl(text),
        "' is not one to eight digits and a unit of H, M, S, m, u or n, for example 250m"));
  };
  if (text.size() < 2 || text.size() > 9) return malformed();
  const std::string_view digits = text.substr(0, text.size() - 1);
  const std::optional<std::uint64_t> parsed = base::ParseDigits(digits);
  if (!parsed.has_value()) return malformed();
  const auto count = static_cast<int64_t>(*parsed);
  switch (text.back()) {
    case 'H':
      return absl::Hours(count);
    case 'M':
      return absl::Minutes(count);
    case 'S':
      return absl::Seconds(count);
    case 'm':
      return absl::Milliseconds(count);
    case 'u':
      return absl::Microseconds(count);
    case 'n':
      return absl::Nanoseconds(count);
    default:
      return malformed();
  }
}

absl::Status AddRequestHeader(std::string_view name, std::string_view value, Metadata& metadata) {
  const std::string key = absl::AsciiStrToLower(Absl(name));
  if (IsNotMetadata(key)) return absl::OkStatus();
  if (!IsLegalName(key)) {
    return absl::InvalidArgumentError(
        absl::StrCat("header '", key,
                     "' cannot be gRPC metadata; its name may contain a-z, 0-9, '-', '_', '.'"));
  }
  if (!IsLegalText(value)) {
    return absl::InvalidArgumentError(
        absl::StrCat("the value of header '", key,
                     "' has bytes outside printable ASCII; use a name ending in -bin"));
  }
  if (!IsBinaryName(key)) {
    metadata.emplace_back(key, std::string(value));
    return absl::OkStatus();
  }
  // HTTP allows several values of one name to be joined by commas. Base64 contains no commas, so
  // the values can be separated.
  for (const absl::string_view part : absl::StrSplit(Absl(value), ',')) {
    std::string bytes;
    if (!absl::Base64Unescape(absl::StripAsciiWhitespace(part), &bytes)) {
      return absl::InvalidArgumentError(
          absl::StrCat("the value of binary header '", key, "' is not base64"));
    }
    metadata.emplace_back(key, std::move(bytes));
  }
  return absl::OkStatus();
}

bool IsForwardedToBrowser(std::string_view name) {
  if (name == "grpc-status-details-bin") return true;
  static constexpr std::string_view kNames[] = {"connection", "content-length",    "content-type",
                                                "date",       "keep-alive",        "trailer",
                                                "te",         "transfer-encoding", "upgrade"};
  return !name.starts_with("grpc-") && !name.starts_with("access-control-") &&
         std::find(std::begin(kNames), std::end(kNames), name) == std::end(kNames);
}

std::string EncodeValue(std::string_view name, std::string_view value) {
  if (!IsBinaryName(name)) return std::string(value);
  std::string encoded = absl::Base64Escape(Absl(value));
  encoded.erase(encoded.find_last_not_of('=') + 1);
  return encoded;
}

}  // namespace thunderhead::gateway
