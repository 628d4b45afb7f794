#include "access/token_list.h"

#include <openssl/crypto.h>
#include <openssl/sha.h>

#include <algorithm>
#include <cctype>

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "base/status.h"

namespace thunderhead::access {
namespace {

constexpr std::size_t kMaxNameBytes = 64;

bool IsHex(const std::string& text) {
  return std::ranges::all_of(text, [](unsigned char c) { return std::isxdigit(c) != 0; });
}

}  // namespace

absl::StatusOr<TokenList::Entry> TokenList::ParseLine(const std::string& line) {
  const std::vector<std::string> parts =
      absl::StrSplit(line, absl::ByAnyChar(" \t"), absl::SkipEmpty());
  if (parts.size() != 3) {
    return absl::InvalidArgumentError(
        "does not have three words: a name, a role and the SHA-256 of the token");
  }
  if (parts[0].size() > kMaxNameBytes) {
    return absl::InvalidArgumentError(
        absl::StrCat("has a name of more than ", kMaxNameBytes, " bytes"));
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(const Role role, ParseRole(parts[1]));
  Entry entry{{parts[0], role}, {}};
  if (parts[2].size() != 2 * entry.digest.size() || !IsHex(parts[2])) {
    return absl::InvalidArgumentError("has no SHA-256 in 64 hexadecimal digits as its third word");
  }
  const std::string bytes = absl::HexStringToBytes(parts[2]);
  std::ranges::copy(bytes, entry.digest.begin());
  return entry;
}

absl::StatusOr<TokenList> TokenList::Parse(const std::string& text) {
  TokenList list;
  int number = 0;
  const std::vector<std::string> lines = absl::StrSplit(text, '\n');
  for (const std::string& line : lines) {
    ++number;
    const absl::string_view content = absl::StripAsciiWhitespace(line);
    if (content.empty() || content.front() == '#') continue;
    absl::StatusOr<Entry> entry = ParseLine(std::string(content));
    if (!entry.ok()) {
      // The message does not repeat the line, because the line may contain a token by mistake.
      return absl::InvalidArgumentError(
          absl::StrCat("line ", number, " of the token file ", entry.status().message()));
    }
    list.entries_.push_back(*std::move(entry));
  }
  if (list.entries_.empty()) {
    return absl::InvalidArgumentError(
        "the token file lists no token, so no one could use the server; add lines with a name, a "
        "role and the SHA-256 of a token");
  }
  return list;
}

std::optional<Identity> TokenList::Find(const std::string& token) const {
  Digest digest;
  SHA256(reinterpret_cast<const unsigned char*>(token.data()), token.size(), digest.data());
  const Entry* found = nullptr;
  for (const Entry& entry : entries_) {
    if (CRYPTO_memcmp(entry.digest.data(), digest.data(), digest.size()) == 0) found = &entry;
  }
  if (found == nullptr) return std::nullopt;
  return found->identity;
}

}  // namespace thunderhead::access
