// Identifies the caller of a call. There are three implementations: by the client's address alone,
// by a file of tokens, or by JSON Web Tokens (JWT).
#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "access/identity.h"
#include "access/jwt_key.h"
#include "base/time_source.h"

namespace thunderhead::access {

class Authenticator {
 public:
  virtual ~Authenticator() = default;
  // Returns UNAUTHENTICATED if the credentials are unknown. Safe from any thread.
  virtual absl::StatusOr<Identity> Identify(const Credentials& credentials) = 0;
};

// Makes every caller an operator, named by the network from which it connects.
std::unique_ptr<Authenticator> TrustEverybody();

// Identifies callers by the tokens in the file at `path` (token_list.h). The file is read again
// when it changes. `time` measures the timeout for reading the file, and must outlive the
// authenticator. Returns the errors of ReadSecretFile, and INVALID_ARGUMENT for malformed contents.
absl::StatusOr<std::unique_ptr<Authenticator>> TrustTokens(
    const std::string& path, const base::TimeSource& time = base::SteadyTime());

// Identifies callers by JWTs that the key in the file at `path` verifies (jwt_key.h). The file is
// read again when it changes. Logs a warning if `wanted` names no audience, because tokens for
// other services are then accepted, which RFC 7519, 4.1.3 forbids. Returns the same errors as
// TrustTokens.
absl::StatusOr<std::unique_ptr<Authenticator>> TrustJwt(const std::string& path,
                                                        const JwtClaims& wanted);

}  // namespace thunderhead::access
