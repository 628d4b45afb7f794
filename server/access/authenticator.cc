#include "access/authenticator.h"

#include <optional>
#include <utility>

#include "access/secret_file.h"
#include "access/token_list.h"
#include "base/client_network.h"
#include "base/error_details.h"
#include "base/status.h"
#include "spdlog/spdlog.h"

namespace thunderhead::access {
namespace {

absl::Status NoToken() {
  return base::WithDetails(
      absl::UnauthenticatedError(
          "this server needs a token: send it as the header 'authorization: Bearer TOKEN'"),
      {.reason = "TOKEN_MISSING"});
}

class Everybody final : public Authenticator {
 public:
  absl::StatusOr<Identity> Identify(const Credentials& credentials) override {
    return Identity{base::NetworkOf(credentials.peer), Role::kOperator};
  }
};

class Tokens final : public Authenticator {
 public:
  explicit Tokens(std::unique_ptr<KeptFile<TokenList>> file) : file_(std::move(file)) {}

  absl::StatusOr<Identity> Identify(const Credentials& credentials) override {
    if (credentials.token.empty()) return NoToken();
    if (const auto found = file_->Current()->Find(credentials.token); found.has_value()) {
      return *found;
    }
    return base::WithDetails(absl::UnauthenticatedError(
                                 "the server does not know this token; ask the server's operator"),
                             {.reason = "TOKEN_UNKNOWN"});
  }

 private:
  const std::unique_ptr<KeptFile<TokenList>> file_;
};

class Jwts final : public Authenticator {
 public:
  Jwts(std::unique_ptr<KeptFile<JwtKey>> file, JwtClaims wanted)
      : file_(std::move(file)), wanted_(std::move(wanted)) {}

  absl::StatusOr<Identity> Identify(const Credentials& credentials) override {
    if (credentials.token.empty()) return NoToken();
    auto identity =
        file_->Current()->Verify(credentials.token, wanted_, std::chrono::system_clock::now());
    if (identity.ok()) return identity;
    return base::WithDetails(identity.status(), {.reason = "TOKEN_INVALID"});
  }

 private:
  const std::unique_ptr<KeptFile<JwtKey>> file_;
  const JwtClaims wanted_;
};

}  // namespace

std::unique_ptr<Authenticator> TrustEverybody() { return std::make_unique<Everybody>(); }

absl::StatusOr<std::unique_ptr<Authenticator>> TrustTokens(const std::string& path,
                                                           const base::TimeSource& time) {
  THUNDERHEAD_ASSIGN_OR_RETURN(auto file, KeptFile<TokenList>::Open(path, &TokenList::Parse, time));
  return std::make_unique<Tokens>(std::move(file));
}

absl::StatusOr<std::unique_ptr<Authenticator>> TrustJwt(const std::string& path,
                                                        const JwtClaims& wanted) {
  THUNDERHEAD_ASSIGN_OR_RETURN(auto file, KeptFile<JwtKey>::Open(path, &JwtKey::Parse));
  if (wanted.audience.empty()) {
    spdlog::warn(
        "--jwt-audience is not given: tokens of every audience (aud) are accepted, also those for "
        "other services; give --jwt-audience if the tokens for this server have aud");
  }
  return std::make_unique<Jwts>(std::move(file), wanted);
}

}  // namespace thunderhead::access
