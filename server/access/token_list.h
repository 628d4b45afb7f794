// The tokens in a file. Each line has a name, a role and the SHA-256 of the token. The tokens
// themselves are not stored on the server. They must be random, for example from `openssl rand -hex
// 32`, because a chosen word could be guessed.
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
  // Parses the file's text. INVALID_ARGUMENT names the line.
  static absl::StatusOr<TokenList> Parse(const std::string& text);

  // Returns the identity of a token. The call takes the same time for every token, so that its
  // duration reveals nothing about valid tokens.
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
