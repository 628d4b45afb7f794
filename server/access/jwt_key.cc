#include "access/jwt_key.h"

#include <jwt.h>
#include <openssl/bio.h>
#include <openssl/evp.h>
#include <openssl/pem.h>

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <string_view>
#include <vector>

#include "absl/strings/escaping.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "access/jwt_secret.h"
#include "base/status.h"
#include "nlohmann/json.hpp"

namespace thunderhead::access {
namespace {

using Time = std::chrono::system_clock::time_point;

// The minimum length of a key, as RFC 7518, 3.3 requires.
constexpr int kMinRsaBits = 2048;
constexpr std::size_t kMaxTokenBytes = 8192;
constexpr std::size_t kMaxClaimBytes = 64;
// Tolerated difference between the clocks of the issuer and the server.
constexpr std::chrono::seconds kClockSkew{30};
constexpr char kRoleClaim[] = "thunderhead_role";

using Token = std::unique_ptr<jwt_t, decltype(&jwt_free)>;

absl::Status Wrong(const std::string& problem) {
  return absl::UnauthenticatedError(absl::StrCat("the token ", problem));
}

absl::Status CheckPublicKey(const std::string& pem) {
  const std::unique_ptr<BIO, decltype(&BIO_free)> bytes(
      BIO_new_mem_buf(pem.data(), static_cast<int>(pem.size())), &BIO_free);
  const std::unique_ptr<EVP_PKEY, decltype(&EVP_PKEY_free)> key(
      PEM_read_bio_PUBKEY(bytes.get(), nullptr, nullptr, nullptr), &EVP_PKEY_free);
  if (key == nullptr || EVP_PKEY_base_id(key.get()) != EVP_PKEY_RSA ||
      EVP_PKEY_bits(key.get()) < kMinRsaBits) {
    return absl::InvalidArgumentError(
        absl::StrCat("the JWT key is PEM but not a public RSA key of at least ", kMinRsaBits,
                     " bits; make one from a private key with openssl pkey -pubout, or from a "
                     "certificate with openssl x509 -pubkey -noout"));
  }
  return absl::OkStatus();
}

std::string TextClaim(jwt_t* token, const char* name) {
  const char* text = jwt_get_grant(token, name);
  return text == nullptr ? "" : text;
}

// Returns the time in a claim. For a missing claim, or a claim that is not a number, the result is
// the epoch (1970), because libjwt then returns -1 or 0. The time is limited to a day before the
// last time that the clock can represent, in the year 2262.
Time TimeClaim(jwt_t* token, const char* name) {
  constexpr long kLast_s =
      std::chrono::floor<std::chrono::seconds>(Time::max() - std::chrono::hours(24))
          .time_since_epoch()
          .count();
  return std::chrono::system_clock::from_time_t(
      std::clamp(jwt_get_grant_int(token, name), 0L, kLast_s));
}

// Returns whether the token's audience, which is a text or a list of texts (RFC 7519, 4.1.3),
// contains `audience`.
bool IsFor(jwt_t* token, const std::string& audience) {
  if (TextClaim(token, "aud") == audience) return true;
  const std::unique_ptr<char, decltype(&std::free)> json(jwt_get_grants_json(token, "aud"),
                                                         &std::free);
  if (json == nullptr) return false;
  constexpr bool kThrows = false;
  const auto list = nlohmann::json::parse(json.get(), nullptr, kThrows);
  return list.is_array() &&
         std::ranges::any_of(list, [&](const nlohmann::json& each) { return each == audience; });
}

// Rejects two kinds of invalid tokens that libjwt accepts. The first has characters outside the
// base64url alphabet after its signature. The second has a header that requires the reader to
// support extensions (crit, RFC 7515, 4.1.11), because this reader supports none.
absl::Status CheckForm(const std::string& token) {
  constexpr std::string_view kBase64Url =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
  const std::vector<std::string> parts = absl::StrSplit(token, '.');
  const bool is_base64 = std::ranges::all_of(parts, [&](const std::string& part) {
    return !part.empty() && part.find_first_not_of(kBase64Url) == std::string::npos;
  });
  std::string header;
  if (parts.size() != 3 || !is_base64 || !absl::WebSafeBase64Unescape(parts[0], &header)) {
    return Wrong("does not have the form of a signed token: three parts in base64url (RFC 7515)");
  }
  constexpr bool kThrows = false;
  const auto fields = nlohmann::json::parse(header, nullptr, kThrows);
  if (!fields.is_object()) return Wrong("has a header that is not a JSON object");
  if (fields.contains("crit")) {
    return Wrong("demands extensions (crit) that this server does not have");
  }
  return absl::OkStatus();
}

// Returns whether the token is already valid at `now` (claim nbf, RFC 7519, 4.1.5). Returns false
// if the claim is not a number. The claim is parsed here, because it may have fractions, and libjwt
// returns 0 for anything but a whole number.
bool HasBegun(jwt_t* token, Time now) {
  const std::unique_ptr<char, decltype(&std::free)> json(jwt_get_grants_json(token, nullptr),
                                                         &std::free);
  if (json == nullptr) return true;
  constexpr bool kThrows = false;
  const auto claims = nlohmann::json::parse(json.get(), nullptr, kThrows);
  if (!claims.is_object()) return false;
  const auto begins = claims.find("nbf");
  if (begins == claims.end()) return true;
  const std::chrono::duration<double> latest = (now + kClockSkew).time_since_epoch();
  return begins->is_number() && begins->get<double>() <= latest.count();
}

absl::Status CheckTimes(jwt_t* token, Time now) {
  const Time expires = TimeClaim(token, "exp");
  if (expires == Time()) return Wrong("has no time at which it expires (exp)");
  if (expires + kClockSkew <= now) return Wrong("has expired");
  if (!HasBegun(token, now)) return Wrong("is not valid yet");
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<JwtKey> JwtKey::Parse(const std::string& text) {
  JwtKey key;
  key.key_ = text;
  key.is_public_ = absl::StrContains(text, "-----BEGIN");
  if (key.is_public_) {
    THUNDERHEAD_RETURN_IF_ERROR(CheckPublicKey(text));
    return key;
  }
  while (!key.key_.empty() && (key.key_.back() == '\n' || key.key_.back() == '\r')) {
    key.key_.pop_back();
  }
  THUNDERHEAD_RETURN_IF_ERROR(CheckSecret(key.key_));
  return key;
}

absl::StatusOr<Identity> JwtKey::Verify(const std::string& token, const JwtClaims& wanted,
                                        Time now) const {
  if (token.size() > kMaxTokenBytes) return Wrong("is too long");
  THUNDERHEAD_RETURN_IF_ERROR(CheckForm(token));
  jwt_t* decoded = nullptr;
  const int error =
      jwt_decode(&decoded, token.c_str(), reinterpret_cast<const unsigned char*>(key_.data()),
                 static_cast<int>(key_.size()));
  const Token owned(decoded, &jwt_free);
  // The token's algorithm must be that of the key. Otherwise anyone could sign a token by HS256
  // with the text of the public key as the secret.
  if (error != 0 || jwt_get_alg(decoded) != (is_public_ ? JWT_ALG_RS256 : JWT_ALG_HS256)) {
    return Wrong("is not signed with this server's key");
  }
  THUNDERHEAD_RETURN_IF_ERROR(CheckTimes(decoded, now));
  if (!wanted.issuer.empty() && TextClaim(decoded, "iss") != wanted.issuer) {
    return Wrong("is of another issuer (iss)");
  }
  if (!wanted.audience.empty() && !IsFor(decoded, wanted.audience)) {
    return Wrong("is for another audience (aud)");
  }
  const std::string name = TextClaim(decoded, "sub");
  if (name.empty() || name.size() > kMaxClaimBytes) {
    return Wrong(absl::StrCat("has no name of 1 to ", kMaxClaimBytes, " bytes (sub)"));
  }
  const absl::StatusOr<Role> role = ParseRole(TextClaim(decoded, kRoleClaim));
  if (!role.ok()) return Wrong(absl::StrCat("has no role (", kRoleClaim, ")"));
  return Identity{name, *role, TimeClaim(decoded, "exp")};
}

}  // namespace thunderhead::access
