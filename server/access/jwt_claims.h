// Checks the claims of a token whose signature is valid.
#pragma once

#include <chrono>

#include "absl/status/statusor.h"
#include "access/identity.h"
#include "access/jwt_key.h"
#include "nlohmann/json_fwd.hpp"

namespace thunderhead::access {

// Returns UNAUTHENTICATED with the message "the token " and `problem`, such as "has expired (exp)".
absl::Status WrongToken(const std::string& problem);

// Returns the identity of a caller who presents a token with these claims, a JSON object, at `now`.
// Returns UNAUTHENTICATED if the token is expired or not yet valid, or if a claim is missing or has
// another form or value. The message names the claim.
absl::StatusOr<Identity> IdentityOf(const nlohmann::json& claims, const JwtClaims& wanted,
                                    std::chrono::system_clock::time_point now);

}  // namespace thunderhead::access
