#include "base/utf8.h"

#include <algorithm>
#include <array>
#include <cstdint>

namespace thunderhead::base {
namespace {

struct Range {
  std::uint32_t first;
  std::uint32_t last;
};

// The characters that are hidden, in order. Their general category in Unicode is Cc (control), Cf
// (format), Co (private use), Zl or Zp (separators). The others have the property
// Default_Ignorable_Code_Point, or will never be characters. The test PrintableCategories compares
// the table with the categories.
constexpr std::array kHidden = {
    Range{0x00, 0x1f}, Range{0x7f, 0x9f},              // control characters
    Range{0xad, 0xad},                                 // soft hyphen
    Range{0x34f, 0x34f},                               // combining grapheme joiner
    Range{0x600, 0x605},                               // Arabic signs around numbers
    Range{0x61c, 0x61c},                               // Arabic letter mark
    Range{0x6dd, 0x6dd}, Range{0x70f, 0x70f},          // Arabic and Syriac signs
    Range{0x890, 0x891}, Range{0x8e2, 0x8e2},          // Arabic signs
    Range{0x115f, 0x1160},                             // Hangul fillers
    Range{0x17b4, 0x17b5},                             // invisible Khmer vowels
    Range{0x180b, 0x180f},                             // Mongolian variation selectors
    Range{0x200b, 0x200f},                             // spaces without width, joiners,
                                                       // direction marks
    Range{0x2028, 0x202e},                             // separators, embeddings, overrides
    Range{0x2060, 0x206f},                             // invisible operators, isolates
    Range{0x3164, 0x3164},                             // Hangul filler
    Range{0xe000, 0xf8ff},                             // private use
    Range{0xfdd0, 0xfdef},                             // never characters
    Range{0xfe00, 0xfe0f},                             // variation selectors
    Range{0xfeff, 0xfeff},                             // byte order mark
    Range{0xffa0, 0xffa0},                             // Hangul filler
    Range{0xfff0, 0xfffb},                             // annotations
    Range{0x110bd, 0x110bd}, Range{0x110cd, 0x110cd},  // Kaithi number signs
    Range{0x13430, 0x1343f},                           // joiners of hieroglyphs
    Range{0x1bca0, 0x1bca3},                           // controls of shorthand
    Range{0x1d173, 0x1d17a},                           // controls of music
    Range{0xe0000, 0xe0fff},                           // tags, variation selectors
    Range{0xf0000, 0x10ffff},                          // private use
};

constexpr std::uint32_t kNonJoiner = 0x200c;
constexpr std::uint32_t kJoiner = 0x200d;
constexpr std::uint32_t kTextStyle = 0xfe0e;   // variation selector for text
constexpr std::uint32_t kEmojiStyle = 0xfe0f;  // variation selector for emoji

// The first character of the scripts that need joiners. Latin, Greek and Cyrillic come before it.
constexpr std::uint32_t kFirstJoined = 0x590;

bool IsHidden(std::uint32_t code) {
  if ((code & 0xfffeU) == 0xfffeU) return true;  // the last two of each plane are never characters
  const auto range = std::ranges::lower_bound(kHidden, code, {}, &Range::last);
  return range != kHidden.end() && range->first <= code;
}

// Returns the code point of one valid UTF-8 character, or 0 for an empty text.
std::uint32_t CodePointOf(std::string_view character) {
  if (character.empty()) return 0;
  const auto first = static_cast<unsigned char>(character[0]);
  if (character.size() == 1) return first;
  std::uint32_t code = first & (0x7fU >> character.size());
  for (const char byte : character.substr(1)) {
    code = code << 6U | (static_cast<unsigned char>(byte) & 0x3fU);
  }
  return code;
}

bool IsStyle(std::uint32_t code) { return code == kTextStyle || code == kEmojiStyle; }

bool MayBeJoined(std::uint32_t code) { return code >= kFirstJoined && !IsHidden(code); }

// Returns whether a hidden character is kept, because its script needs it. `before` is the
// character before it. It is 0 if that character was replaced. `after` is the text after it.
bool IsKept(std::uint32_t code, std::uint32_t before, std::string_view after) {
  if (IsStyle(code)) return MayBeJoined(before);
  if (code != kNonJoiner && code != kJoiner) return false;
  const std::uint32_t next = CodePointOf(after.substr(0, Utf8CharacterBytes(after)));
  return (MayBeJoined(before) || IsStyle(before)) && MayBeJoined(next);
}

}  // namespace

std::size_t Utf8CharacterBytes(std::string_view text) {
  const auto byte = [text](std::size_t i) {
    return i < text.size() ? static_cast<unsigned char>(text[i]) : 0U;
  };
  const unsigned lead = byte(0);
  if (lead < 0x80) return text.empty() ? 0 : 1;
  if (lead < 0xc2 || lead > 0xf4) return 0;
  const std::size_t bytes = lead < 0xe0 ? 2 : lead < 0xf0 ? 3 : 4;
  for (std::size_t i = 1; i < bytes; ++i) {
    if ((byte(i) & 0xc0) != 0x80) return 0;
  }
  // Rejects overlong encodings, UTF-16 surrogates and values beyond Unicode.
  const bool wrong = (lead == 0xe0 && byte(1) < 0xa0) || (lead == 0xed && byte(1) > 0x9f) ||
                     (lead == 0xf0 && byte(1) < 0x90) || (lead == 0xf4 && byte(1) > 0x8f);
  return wrong ? 0 : bytes;
}

std::string Printable(std::string_view text, const PrintableLimits& limits) {
  constexpr std::string_view kMore = "\u2026";
  std::string printable;
  std::size_t cut = 0;  // the size at which `printable` can be cut so that kMore fits
  std::uint32_t before = 0;
  while (!text.empty()) {
    const std::size_t size = Utf8CharacterBytes(text);
    const std::string_view character = text.substr(0, size);
    text.remove_prefix(size == 0 ? 1 : size);
    const std::uint32_t code = CodePointOf(character);
    const bool shown = size > 0 && (!IsHidden(code) || IsKept(code, before, text));
    before = shown ? code : 0;
    if (shown) {
      printable += character;
    } else {
      printable += limits.instead;
    }
    if (printable.size() > limits.max_bytes) {
      printable.resize(cut);
      return printable.append(kMore);
    }
    if (printable.size() + kMore.size() <= limits.max_bytes) cut = printable.size();
  }
  return printable;
}

}  // namespace thunderhead::base
