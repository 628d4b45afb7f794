#include "access/jwt_claims.h"

#include <algorithm>
#include <optional>
#include <string>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "base/status.h"
#include "nlohmann/json.hpp"

namespace thunderhead::access {
namespace {

using nlohmann::json;
using Time = std::chrono::system_clock::time_point;
using Seconds = std::chrono::duration<double>;

constexpr std::size_t kMaxClaimBytes = 64;
// Tolerated difference between the clocks of the issuer and the server.
constexpr Seconds kClockSkew{30.0};
constexpr char kRoleClaim[] = "thunderhead_role";

// Returns the number of seconds since 1970 in a claim, or nothing if there is no such claim. The
// number may have a fraction (RFC 7519, 2). `what` describes the claim in errors.
absl::StatusOr<std::optional<double>> TimeClaim(const json& claims, const char* name,
                                                const char* what) {
  const auto claim = claims.find(name);
  if (claim == claims.end()) return std::nullopt;
  if (claim->is_number()) return claim->get<double>();
  return WrongToken(
      absl::StrCat("has ", what, " (", name, ") that is not a number of seconds since 1970"));
}

// Converts seconds since 1970. The time is limited to a day before the last time that the clock can
// represent, in the year 2262.
Time TimeOf(double seconds) {
  static const double kLast_s =
      Seconds((Time::max() - std::chrono::hours(24)).time_since_epoch()).count();
  return Time(
      std::chrono::duration_cast<Time::duration>(Seconds(std::clamp(seconds, 0.0, kLast_s))));
}

absl::StatusOr<Time> CheckTimes(const json& claims, Time now) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::optional<double> expires,
                               TimeClaim(claims, "exp", "a time at which it expires"));
  if (!expires.has_value()) return WrongToken("has no time at which it expires (exp)");
  const Seconds now_s = now.time_since_epoch();
  if (*expires + kClockSkew.count() <= now_s.count()) return WrongToken("has expired (exp)");
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::optional<double> begins,
                               TimeClaim(claims, "nbf", "a time from which it is valid"));
  if (begins.has_value() && *begins > (now_s + kClockSkew).count()) {
    return WrongToken("is not valid yet (nbf)");
  }
  return TimeOf(*expires);
}

// Returns the text of a claim. `what` describes the claim in errors.
absl::StatusOr<std::string> TextClaim(const json& claims, const char* name, const char* what) {
  const auto claim = claims.find(name);
  if (claim == claims.end()) return WrongToken(absl::StrCat("has no ", what, " (", name, ")"));
  if (claim->is_string()) return claim->get<std::string>();
  return WrongToken(
      absl::StrCat("has a claim ", name, " that is not a text, as the ", what, " must be"));
}

absl::Status CheckIssuer(const json& claims, const std::string& wanted) {
  if (wanted.empty()) return absl::OkStatus();
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::string issuer, TextClaim(claims, "iss", "issuer"));
  return issuer == wanted ? absl::OkStatus() : WrongToken("is of another issuer (iss)");
}

// Checks the token's audience, which is a text or a list of texts (RFC 7519, 4.1.3).
absl::Status CheckAudience(const json& claims, const std::string& wanted) {
  if (wanted.empty()) return absl::OkStatus();
  const auto claim = claims.find("aud");
  if (claim == claims.end()) return WrongToken("has no audience (aud)");
  const bool is_in_list = claim->is_array() && std::ranges::any_of(*claim, [&](const json& each) {
                            return each == wanted;
                          });
  if (*claim == wanted || is_in_list) return absl::OkStatus();
  return WrongToken("is for another audience (aud)");
}

absl::StatusOr<std::string> NameOfHolder(const json& claims) {
  THUNDERHEAD_ASSIGN_OR_RETURN(std::string name, TextClaim(claims, "sub", "name"));
  if (absl::StrContains(name, '\0')) return WrongToken("has a name (sub) with a NUL character");
  if (!name.empty() && name.size() <= kMaxClaimBytes) return name;
  return WrongToken(absl::StrCat("has a name (sub) of ", name.size(), " bytes, and 1 to ",
                                 kMaxClaimBytes, " are allowed"));
}

absl::StatusOr<Role> RoleOfHolder(const json& claims) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::string text, TextClaim(claims, kRoleClaim, "role"));
  absl::StatusOr<Role> role = ParseRole(text);
  if (role.ok()) return role;
  return WrongToken(absl::StrCat("has another role (", kRoleClaim,
                                 ") than viewer, presenter, pipeline or operator"));
}

}  // namespace

absl::Status WrongToken(const std::string& problem) {
  return absl::UnauthenticatedError(absl::StrCat("the token ", problem));
}

absl::StatusOr<Identity> IdentityOf(const json& claims, const JwtClaims& wanted, Time now) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const Time expires, CheckTimes(claims, now));
  THUNDERHEAD_RETURN_IF_ERROR(CheckIssuer(claims, wanted.issuer));
  THUNDERHEAD_RETURN_IF_ERROR(CheckAudience(claims, wanted.audience));
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::string name, NameOfHolder(claims));
  THUNDERHEAD_ASSIGN_OR_RETURN(const Role role, RoleOfHolder(claims));
  return Identity{name, role, expires};
}

}  // namespace thunderhead::access
