// Verifies JSON Web Tokens (RFC 7519) that another system issues. The tokens are signed by HS256
// with a shared secret, or by RS256. The server's key determines the algorithm; the algorithm in
// the token's header is not trusted.
#pragma once

#include <chrono>
#include <string>

#include "absl/status/statusor.h"
#include "access/identity.h"

namespace thunderhead::access {

// Claims that a token must have in addition to sub, exp and the role.
struct JwtClaims {
  std::string issuer;    // empty if any value is accepted
  std::string audience;  // empty if any value is accepted
};

class JwtKey {
 public:
  // Parses a key. A PEM public key is for RS256. Other text, without the newlines at its end, is a
  // secret for HS256. Returns INVALID_ARGUMENT for a PEM key other than a public RSA key of at
  // least 2048 bits. Also returns it for text that cannot be a secret (jwt_secret.h), such as text
  // of less than 32 bytes or a key in another form.
  static absl::StatusOr<JwtKey> Parse(const std::string& text);

  // Accepts tokens of the types JWT and at+jwt (RFC 9068), and tokens without a type (typ). Returns
  // UNAUTHENTICATED if the token is of another type, malformed, forged, expired or not yet valid,
  // or if a claim is missing or has another value than required.
  absl::StatusOr<Identity> Verify(const std::string& token, const JwtClaims& wanted,
                                  std::chrono::system_clock::time_point now) const;

 private:
  bool is_public_ = false;
  std::string key_;
};

}  // namespace thunderhead::access
