// Cleans text from outside before it leaves the process. Such text comes from files (names and
// attributes) and from clients (marks, titles and other request fields). It appears in API
// messages, whose strings must be valid UTF-8, in logs, in the audit log, in HTTP headers and in
// file names.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace thunderhead::base {

// Returns the length in bytes of the UTF-8 character at the start of `text`, or 0 if it is invalid.
std::size_t Utf8CharacterBytes(std::string_view text);

// Returns `text` as one line of valid UTF-8. Replaces these by question marks, because they can
// make a log line or a file name look like a different one:
//
// - Each byte that belongs to no UTF-8 character.
// - Each control character (U+0000 to U+001F, U+007F to U+009F).
// - Each line or paragraph separator (U+2028, U+2029).
// - Each character that changes the direction of text (U+202A to U+202E, U+2066 to U+2069).
std::string Printable(std::string_view text);

}  // namespace thunderhead::base
