#include "gateway/websocket_protocol.h"

#include <algorithm>

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"

namespace thunderhead::gateway {

using boost::beast::websocket::close_code;
using boost::beast::websocket::close_reason;

bool OffersSubprotocol(std::string_view offered) {
  for (const absl::string_view name :
       absl::StrSplit(absl::string_view(offered.data(), offered.size()), ',')) {
    if (absl::StripAsciiWhitespace(name) == kWebSocketSubprotocol) return true;
  }
  return false;
}

std::optional<std::string> OfferedToken(std::string_view offered) {
  for (absl::string_view name :
       absl::StrSplit(absl::string_view(offered.data(), offered.size()), ',')) {
    name = absl::StripAsciiWhitespace(name);
    std::string token;
    if (!absl::ConsumePrefix(&name, kTokenPrefix) || !absl::WebSafeBase64Unescape(name, &token)) {
      continue;
    }
    // gRPC aborts the process on metadata with other bytes, so they are rejected.
    const bool printable =
        std::ranges::all_of(token, [](unsigned char c) { return absl::ascii_isgraph(c); });
    if (printable && !token.empty()) return token;
  }
  return std::nullopt;
}

std::optional<close_reason> FindViolation(const MessageStart& start) {
  const auto violation = [](close_code code, const std::string& reason) {
    return close_reason(code, reason);
  };
  if (start.is_text) {
    return violation(close_code::unknown_data, "send binary messages, not text");
  }
  if (!start.kind.has_value()) {
    return violation(close_code::policy_error, "an empty message has no kind in its first byte");
  }
  if (*start.kind != kMessageKind && *start.kind != kHalfCloseKind) {
    return violation(close_code::policy_error,
                     absl::StrCat("messages of kind 0x", absl::Hex(*start.kind),
                                  " are unknown; send 0x0 (message) or 0x1 (half-close)"));
  }
  if (start.after_half_close) {
    return violation(close_code::policy_error, "nothing may follow a half-close");
  }
  if (*start.kind == kHalfCloseKind && start.has_payload) {
    return violation(close_code::policy_error, "a half-close must have no payload");
  }
  return std::nullopt;
}

std::string CloseFrame(const close_reason& reason) {
  constexpr char kCloseHead = '\x88';
  const std::string_view text(reason.reason.data(), reason.reason.size());
  std::string frame = {kCloseHead, static_cast<char>(2 + text.size()),
                       static_cast<char>(reason.code >> 8U),
                       static_cast<char>(reason.code & 0xffU)};
  frame += text;
  return frame;
}

}  // namespace thunderhead::gateway
