// Fuzzes the parsers that control access: lists of tokens, keys and JSON Web Tokens, and tokens in
// headers.
#include <cstdint>
#include <cstdlib>
#include <string>

#include "access/jwt_key.h"
#include "access/token_list.h"
#include "gateway/websocket_protocol.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using thunderhead::access::JwtKey;
  using thunderhead::access::TokenList;
  if (size == 0) return 0;
  const std::string text(reinterpret_cast<const char*>(data) + 1, size - 1);
  static const auto key = JwtKey::Parse("a secret that is long enough to be one of HS256");
  switch (data[0] % 4) {
    case 0: {
      const auto list = TokenList::Parse(text);
      if (list.ok() && list->Find("no such token").has_value()) std::abort();
      break;
    }
    case 1:
      static_cast<void>(JwtKey::Parse(text));
      break;
    case 2:
      // No token may verify: only the key's owner can sign one, and the seeds' token has expired.
      if (key->Verify(text, {}, std::chrono::system_clock::now()).ok()) std::abort();
      break;
    default:
      thunderhead::gateway::OffersSubprotocol(text);
      if (const auto token = thunderhead::gateway::OfferedToken(text); token.has_value()) {
        if (token->empty()) std::abort();
      }
  }
  return 0;
}
