#include "base/random_hex.h"

#include <random>

#include "absl/strings/str_format.h"

namespace thunderhead::base {

std::string RandomHex(int words) {
  std::random_device device;
  std::string text;
  for (int word = 0; word < words; ++word) absl::StrAppendFormat(&text, "%08x", device());
  return text;
}

}  // namespace thunderhead::base
