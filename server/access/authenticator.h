// Finds out who calls: by the client's address alone, by a file of tokens, or by JWT.
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
  // UNAUTHENTICATED if it does not know them. Safe from any thread.
  virtual absl::StatusOr<Identity> Identify(const Credentials& credentials) = 0;
};

// Everybody is an operator, named by the network that they come from.
std::unique_ptr<Authenticator> TrustEverybody();

// By the tokens that the file at `path` allows (token_list.h), read again when it changes. `time`,
// by which its storage is waited for, must outlive the authenticator.
absl::StatusOr<std::unique_ptr<Authenticator>> TrustTokens(
    const std::string& path, const base::TimeSource& time = base::SteadyTime());

// By JWTs that the key in the file at `path` verifies (jwt_key.h), read again when it changes.
absl::StatusOr<std::unique_ptr<Authenticator>> TrustJwt(const std::string& path,
                                                        const JwtClaims& wanted);

}  // namespace thunderhead::access
