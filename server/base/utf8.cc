#include "base/utf8.h"

namespace thunderhead::base {
namespace {

// Returns whether a valid UTF-8 character must not appear in a line of text. Printable lists these
// characters.
bool IsUnprintable(std::string_view character) {
  const unsigned char lead = character[0];
  if (character.size() == 1) return lead < 0x20 || lead == 0x7f;
  if (character.size() == 2) return lead == 0xc2 && static_cast<unsigned char>(character[1]) < 0xa0;
  return (character >= "\u2028" && character <= "\u202e") ||
         (character >= "\u2066" && character <= "\u2069");
}

}  // namespace

std::size_t Utf8CharacterBytes(std::string_view text) {
  const auto byte = [text](std::size_t i) {
    return i < text.size() ? static_cast<unsigned char>(text[i]) : 0U;
  };
  const unsigned lead = byte(0);
  if (lead < 0x80) return 1;
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

std::string Printable(std::string_view text) {
  std::string printable;
  while (!text.empty()) {
    const std::size_t size = Utf8CharacterBytes(text);
    const std::string_view character = text.substr(0, size);
    printable += size == 0 || IsUnprintable(character) ? "?" : character;
    text.remove_prefix(size == 0 ? 1 : size);
  }
  return printable;
}

}  // namespace thunderhead::base
