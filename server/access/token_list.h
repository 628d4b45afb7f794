// The tokens that a file allows: a line each with a name, a role and the SHA-256 of the token. The
// tokens themselves are nowhere on the server. They must be random, as by `openssl rand -hex 32`: a
// word that somebody thought of could be found by trying.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "access/identity.h"

namespace thunderhead::access {

class TokenList {
 public:
  // INVALID_ARGUMENT names the line.
  static absl::StatusOr<TokenList> Parse(const std::string& text);

  // Takes the same time whichever token is given.
  std::optional<Identity> Find(const std::string& token) const;

 private:
  using Digest = std::array<std::uint8_t, 32>;

  struct Entry {
    Identity identity;
    Digest digest;
  };

  static absl::StatusOr<Entry> ParseLine(const std::string& line);

  std::vector<Entry> entries_;
};

}  // namespace thunderhead::access
