#include "access/jwt_key.h"

#include <openssl/bio.h>
#include <openssl/crypto.h>
#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/hmac.h>
#include <openssl/pem.h>
#include <openssl/sha.h>

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

using PublicKey = std::unique_ptr<EVP_PKEY, decltype(&EVP_PKEY_free)>;

absl::Status WrongForm() {
  return WrongToken(
      "does not have the form of a signed token: three parts in base64url (RFC 7515)");
}

// Returns the public key in a PEM text, or nothing.
PublicKey ReadPublicKey(const std::string& pem) {
  const std::unique_ptr<BIO, decltype(&BIO_free)> bytes(
      BIO_new_mem_buf(pem.data(), static_cast<int>(pem.size())), &BIO_free);
  PublicKey key(PEM_read_bio_PUBKEY(bytes.get(), nullptr, nullptr, nullptr), &EVP_PKEY_free);
  ERR_clear_error();
  return key;
}

absl::Status CheckPublicKey(const std::string& pem) {
  const PublicKey key = ReadPublicKey(pem);
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
  // A NUL byte or a byte order mark (RFC 8259, 8.1) is an error, although the parser would end at
  // the first and skip the second.
  const bool is_json_alone =
      !absl::StrContains(text, '\0') && !absl::StartsWith(text, "\xEF\xBB\xBF");
  constexpr bool kThrows = false;
  json fields = is_json_alone ? json::parse(text, nullptr, kThrows) : json();
  if (fields.is_object()) return fields;
  return WrongToken(absl::StrCat("has ", what, " that are not a valid JSON object in UTF-8"));
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

// Checks that the header names no other kind of token (typ) than a JWT (RFC 7519, 5.1) or an access
// token (RFC 9068, 2.1). Tokens of other kinds are for other purposes (RFC 8725, 3.11).
absl::Status CheckType(const json& header) {
  const auto type = header.find("typ");
  if (type == header.end()) return absl::OkStatus();
  for (const char* const known : {"JWT", "at+jwt", "application/jwt", "application/at+jwt"}) {
    if (type->is_string() && absl::EqualsIgnoreCase(type->get_ref<const std::string&>(), known)) {
      return absl::OkStatus();
    }
  }
  return WrongToken("has another type (typ) than JWT or at+jwt");
}

// The parts of a token of a valid form, whose signature and claims are not checked yet.
struct ParsedToken {
  std::string_view signed_text;
  std::string signature;
  json claims;
};

// Finds what is wrong with a token apart from its signature and the meaning of its claims. A header
// that requires the reader to support extensions (crit, RFC 7515, 4.1.11) is an error, because this
// reader supports none. The result refers to `token`.
absl::StatusOr<ParsedToken> ParseToken(const std::string& token, const char* algorithm) {
  const std::vector<std::string> parts = absl::StrSplit(token, '.');
  if (parts.size() != 3) return WrongForm();
  ParsedToken parsed;
  for (const std::string& part : parts) {
    // Each part must be the canonical base64url of its bytes. The same token could otherwise be
    // written in other ways.
    const bool is_base64 = absl::WebSafeBase64Unescape(part, &parsed.signature) &&
                           absl::WebSafeBase64Escape(parsed.signature) == part;
    if (!is_base64 || (part.empty() && &part != &parts[2])) return WrongForm();
  }
  if (parts[2].empty()) return WrongToken("has no signature");
  parsed.signed_text = std::string_view(token).substr(0, token.rfind('.'));
  THUNDERHEAD_ASSIGN_OR_RETURN(const json header, ParsePart(parts[0], "header fields"));
  if (header.contains("crit")) {
    return WrongToken("demands extensions (crit) that this server does not have");
  }
  THUNDERHEAD_RETURN_IF_ERROR(CheckAlgorithm(header, algorithm));
  THUNDERHEAD_RETURN_IF_ERROR(CheckType(header));
  THUNDERHEAD_ASSIGN_OR_RETURN(parsed.claims, ParsePart(parts[1], "claims"));
  return parsed;
}

const unsigned char* BytesOf(std::string_view text) {
  return reinterpret_cast<const unsigned char*>(text.data());
}

bool IsSignedByHs256(const ParsedToken& token, const std::string& secret) {
  unsigned char right[SHA256_DIGEST_LENGTH];
  return HMAC(EVP_sha256(), secret.data(), static_cast<int>(secret.size()),
              BytesOf(token.signed_text), token.signed_text.size(), right, nullptr) != nullptr &&
         token.signature.size() == sizeof(right) &&
         CRYPTO_memcmp(token.signature.data(), right, sizeof(right)) == 0;
}

bool IsSignedByRs256(const ParsedToken& token, const std::string& pem) {
  const PublicKey key = ReadPublicKey(pem);
  const std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context(EVP_MD_CTX_new(),
                                                                        &EVP_MD_CTX_free);
  // By default, OpenSSL verifies an RSA signature with the padding of PKCS #1, version 1.5, which
  // RS256 uses.
  const bool is_signed =
      key != nullptr && context != nullptr &&
      EVP_DigestVerifyInit(context.get(), nullptr, EVP_sha256(), nullptr, key.get()) == 1 &&
      EVP_DigestVerify(context.get(), BytesOf(token.signature), token.signature.size(),
                       BytesOf(token.signed_text), token.signed_text.size()) == 1;
  // OpenSSL keeps errors in a queue of this thread. If they stayed there, the thread's next TLS
  // call could report them as its own.
  ERR_clear_error();
  return is_signed;
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
  // The algorithm is that of the key. Otherwise anyone could sign a token by HS256 with the text of
  // the public key as the secret.
  THUNDERHEAD_ASSIGN_OR_RETURN(const ParsedToken parsed,
                               ParseToken(token, is_public_ ? "RS256" : "HS256"));
  const bool is_signed = is_public_ ? IsSignedByRs256(parsed, key_) : IsSignedByHs256(parsed, key_);
  if (!is_signed) return WrongToken("is not signed with this server's key");
  return IdentityOf(parsed.claims, wanted, now);
}

}  // namespace thunderhead::access
