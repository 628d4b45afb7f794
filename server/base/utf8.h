// Cleans text from outside before it leaves the process. Such text comes from files (names and
// attributes) and from clients (marks, titles and other request fields). It appears in API
// messages, whose strings must be valid UTF-8, in logs, in the audit log, in HTTP headers and in
// file names.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace thunderhead::base {

// Returns the length in bytes of the UTF-8 character at the start of `text`, or 0 if it is invalid
// or `text` is empty.
std::size_t Utf8CharacterBytes(std::string_view text);

// The longest text in a message, such as a title or a name. A message with a longer text could
// exceed a limit of its receiver, and then be lost as a whole.
inline constexpr std::size_t kMaxTextBytes = 1024;
// The longest text that is read alone, such as a line of the log.
inline constexpr std::size_t kMaxLineBytes = 16 << 10;

struct PrintableLimits {
  std::size_t max_bytes = kMaxTextBytes;  // at least 3
  char instead = '?';                     // replaces each character that is not printable
};

// Returns `text` as one line of valid UTF-8. A text that would be longer than the limit ends with
// an ellipsis. The function replaces these, because they can make a text look like a different one,
// or like several lines:
//
// - Each byte that belongs to no UTF-8 character.
// - Each character of Unicode's general categories Cc (control), Cf (format, which includes those
//   that change the direction of text), Co (private use), Zl and Zp (separators).
// - Each character that has the property Default_Ignorable_Code_Point, because it is invisible.
//   Among these are tags, fillers and variation selectors.
//
// Persian, the languages of India, and emoji need some invisible characters. The joiners (U+200C,
// U+200D) are kept between two characters from U+0590 on. The variation selectors for text and
// emoji (U+FE0E, U+FE0F) are kept after such a character. A name in Latin, Greek or Cyrillic
// letters thus contains no invisible character. Combining marks are kept, because they are visible,
// and many languages cannot be written without them. Letters that look alike are kept too, so ids
// of storms, and not titles, identify them.
std::string Printable(std::string_view text, const PrintableLimits& limits = {});

}  // namespace thunderhead::base
