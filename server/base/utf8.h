// Text from outside as valid UTF-8, which protobuf's strings must be: names and attributes of files
// may be in any encoding.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace thunderhead::base {

// Length in bytes of the UTF-8 character at the start of `text`; 0 if it is invalid.
std::size_t Utf8CharacterBytes(std::string_view text);

// `text` with a question mark for each byte that belongs to no UTF-8 character.
std::string ValidUtf8(std::string_view text);

}  // namespace thunderhead::base
