#include "access/audit.h"

#include <cstdint>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/time/time.h"
#include "base/error_details.h"

namespace thunderhead::access {
namespace {

// Returns the text in quotes, without any character that could begin a line or end the quotes.
std::string Quoted(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) {
    const bool plain = c >= 0x20 && c < 0x7f && c != '"' && c != '\\';
    if (plain) {
      quoted += c;
    } else {
      absl::StrAppendFormat(&quoted, "\\x%02x", static_cast<unsigned char>(c));
    }
  }
  return quoted + '"';
}

std::string ReasonOf(const absl::Status& status) {
  if (status.ok()) return "";
  const std::string reason = base::DetailsOf(status).reason;
  return reason.empty() ? absl::StatusCodeToString(status.code()) : reason;
}

}  // namespace

void Audit::Write(const Act& act, const absl::Status& status, Clock::time_point now) {
  const std::lock_guard lock(mutex_);
  std::uint64_t left_out = 0;
  if (!status.ok()) {
    const auto taken = (act.before_call ? before_calls_ : calls_).Take(now);
    if (!taken.has_value()) return;
    left_out = *taken;
  }
  std::string line = absl::StrCat(
      "audit time=",
      absl::FormatTime("%Y-%m-%dT%H:%M:%E3SZ", absl::FromChrono(now), absl::UTCTimeZone()),
      " identity=", Quoted(act.identity), " role=", act.role.empty() ? "none" : act.role,
      " peer=", Quoted(act.peer), " act=", act.name,
      " verdict=", status.ok() ? "allowed" : "refused", " reason=", Quoted(ReasonOf(status)));
  if (left_out > 0) absl::StrAppend(&line, " left_out=", left_out);
  write_(line);
}

}  // namespace thunderhead::access
