#include "access/jwt_key.h"

#include <jwt.h>
#include <openssl/bio.h>
#include <openssl/evp.h>
#include <openssl/pem.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <string_view>
#include <vector>

#include "absl/strings/escaping.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "access/jwt_claims.h"
#include "access/jwt_secret.h"
#include "base/status.h"
#include "nlohmann/json.hpp"

namespace thunderhead::access {
namespace {

using nlohmann::json;
using Time = std::chrono::system_clock::time_point;

// The minimum length of a key, as RFC 7518, 3.3 requires.
constexpr int kMinRsaBits = 2048;
constexpr std::size_t kMaxTokenBytes = 8192;

using Token = std::unique_ptr<jwt_t, decltype(&jwt_free)>;

absl::Status WrongForm() {
  return WrongToken(
      "does not have the form of a signed token: three parts in base64url (RFC 7515)");
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

// Parses a part of a token, which is a JSON object in base64url. `what` names the part in errors.
absl::StatusOr<json> ParsePart(const std::string& part, const char* what) {
  std::string text;
  if (!absl::WebSafeBase64Unescape(part, &text)) return WrongForm();
  constexpr bool kThrows = false;
  json fields = json::parse(text, nullptr, kThrows);
  if (fields.is_object()) return fields;
  return WrongToken(absl::StrCat("has ", what, " that are not a valid JSON object in UTF-8"));
}

// Returns the reason why libjwt cannot parse a JSON value, or nothing. libjwt would report it as a
// wrong signature.
const char* UnreadableIn(const json& value, int depth = 0) {
  constexpr int kMaxDepth = 100;
  constexpr double kFirstTooLarge = 9223372036854775808.0;  // 2^63
  if (depth > kMaxDepth) return "that are nested too deeply";
  if (value.is_number() && std::abs(value.get<double>()) >= kFirstTooLarge) {
    return "with a number that is too large";
  }
  if (value.is_string() && absl::StrContains(value.get_ref<const std::string&>(), '\0')) {
    return "with a NUL character";
  }
  if (!value.is_structured()) return nullptr;
  for (const auto& [key, each] : value.items()) {
    if (absl::StrContains(key, '\0')) return "with a NUL character";
    if (const char* const why = UnreadableIn(each, depth + 1); why != nullptr) return why;
  }
  return nullptr;
}

// Checks that the header names the algorithm of the server's key.
absl::Status CheckAlgorithm(const json& header, const char* wanted) {
  const auto algorithm = header.find("alg");
  if (algorithm == header.end() || !algorithm->is_string()) {
    return WrongToken("has a header without the algorithm of its signature (alg)");
  }
  if (absl::EqualsIgnoreCase(algorithm->get_ref<const std::string&>(), wanted)) {
    return absl::OkStatus();
  }
  return WrongToken(absl::StrCat("has another algorithm (alg) than ", wanted,
                                 ", which this server's key is for"));
}

// Finds what is wrong with a token apart from its signature and the meaning of its claims. Rejects
// two kinds of invalid tokens that libjwt accepts. The first has characters outside the base64url
// alphabet after its signature. The second has a header that requires the reader to support
// extensions (crit, RFC 7515, 4.1.11), because this reader supports none.
absl::Status CheckForm(const std::string& token, const char* algorithm) {
  constexpr std::string_view kBase64Url =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
  const std::vector<std::string> parts = absl::StrSplit(token, '.');
  const bool is_base64 = std::ranges::all_of(parts, [&](const std::string& part) {
    return part.find_first_not_of(kBase64Url) == std::string::npos;
  });
  if (parts.size() != 3 || !is_base64 || parts[0].empty() || parts[1].empty()) return WrongForm();
  if (parts[2].empty()) return WrongToken("has no signature");
  THUNDERHEAD_ASSIGN_OR_RETURN(const json header, ParsePart(parts[0], "header fields"));
  if (header.contains("crit")) {
    return WrongToken("demands extensions (crit) that this server does not have");
  }
  THUNDERHEAD_RETURN_IF_ERROR(CheckAlgorithm(header, algorithm));
  THUNDERHEAD_ASSIGN_OR_RETURN(const json claims, ParsePart(parts[1], "claims"));
  for (const json* const part : {&header, &claims}) {
    const char* const why = UnreadableIn(*part);
    if (why == nullptr) continue;
    return WrongToken(absl::StrCat("has ", part == &header ? "header fields " : "claims ", why));
  }
  return absl::OkStatus();
}

// Returns the claims as libjwt has parsed them from the signed text.
absl::StatusOr<json> ClaimsOf(jwt_t* token) {
  const std::unique_ptr<char, decltype(&std::free)> text(jwt_get_grants_json(token, nullptr),
                                                         &std::free);
  constexpr bool kThrows = false;
  json claims = text == nullptr ? json() : json::parse(text.get(), nullptr, kThrows);
  if (claims.is_object()) return claims;
  return WrongToken("has claims that are not a valid JSON object in UTF-8");
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
  if (token.size() > kMaxTokenBytes) return WrongToken("is too long");
  THUNDERHEAD_RETURN_IF_ERROR(CheckForm(token, is_public_ ? "RS256" : "HS256"));
  jwt_t* decoded = nullptr;
  const int error =
      jwt_decode(&decoded, token.c_str(), reinterpret_cast<const unsigned char*>(key_.data()),
                 static_cast<int>(key_.size()));
  const Token owned(decoded, &jwt_free);
  // The token's algorithm must be that of the key. Otherwise anyone could sign a token by HS256
  // with the text of the public key as the secret.
  if (error != 0 || jwt_get_alg(decoded) != (is_public_ ? JWT_ALG_RS256 : JWT_ALG_HS256)) {
    return WrongToken("is not signed with this server's key");
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(const json claims, ClaimsOf(decoded));
  return IdentityOf(claims, wanted, now);
}

}  // namespace thunderhead::access
