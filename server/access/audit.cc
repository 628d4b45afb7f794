#include "access/audit.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/time/time.h"
#include "base/error_details.h"

namespace thunderhead::access {
namespace {

// In quotes, and without anything that could begin a line or end the quotes.
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

bool Audit::Takes(Rate& rate, Clock::time_point now) {
  const auto second = std::chrono::floor<std::chrono::seconds>(now);
  if (second != rate.second) {
    rate.second = second;
    rate.refusals = 0;
  }
  if (++rate.refusals <= kMaxRefusalsPerSecond) return true;
  ++rate.left_out;
  return false;
}

void Audit::Write(const Act& act, const absl::Status& status, Clock::time_point now) {
  const std::lock_guard lock(mutex_);
  Rate& rate = act.before_call ? before_calls_ : calls_;
  if (!status.ok() && !Takes(rate, now)) return;
  std::string line = absl::StrCat(
      "audit time=",
      absl::FormatTime("%Y-%m-%dT%H:%M:%E3SZ", absl::FromChrono(now), absl::UTCTimeZone()),
      " identity=", Quoted(act.identity), " role=", act.role.empty() ? "none" : act.role,
      " peer=", Quoted(act.peer), " act=", act.name,
      " verdict=", status.ok() ? "allowed" : "refused", " reason=", Quoted(ReasonOf(status)));
  if (!status.ok() && rate.left_out > 0) {
    absl::StrAppend(&line, " left_out=", rate.left_out);
    rate.left_out = 0;
  }
  write_(line);
}

}  // namespace thunderhead::access
