// Compares the characters that base::Printable replaces with Unicode's general categories. GLib,
// with which this room's texts are drawn, knows the category of each character.
#include <glib.h>
#include <gtest/gtest.h>

#include <array>
#include <string>
#include <utility>

#include "base/utf8.h"

namespace thunderhead::product {
namespace {

// The assigned characters of other categories that have the property Default_Ignorable_Code_Point.
constexpr std::array<std::pair<gunichar, gunichar>, 9> kIgnorable{{{0x34f, 0x34f},
                                                                   {0x115f, 0x1160},
                                                                   {0x17b4, 0x17b5},
                                                                   {0x180b, 0x180d},
                                                                   {0x180f, 0x180f},
                                                                   {0x3164, 0x3164},
                                                                   {0xfe00, 0xfe0f},
                                                                   {0xffa0, 0xffa0},
                                                                   {0xe0100, 0xe01ef}}};

bool MustBeHidden(gunichar code) {
  for (const auto& [first, last] : kIgnorable) {
    if (first <= code && code <= last) return true;
  }
  switch (g_unichar_type(code)) {
    case G_UNICODE_CONTROL:
    case G_UNICODE_FORMAT:
    case G_UNICODE_PRIVATE_USE:
    case G_UNICODE_LINE_SEPARATOR:
    case G_UNICODE_PARAGRAPH_SEPARATOR:
      return true;
    default:
      return false;
  }
}

TEST(PrintableCategories, ExactlyHiddenCharactersAreReplaced) {
  int replaced = 0;
  for (gunichar code = 0; code <= 0x10ffff; ++code) {
    const bool surrogate = code >= 0xd800 && code <= 0xdfff;
    if (surrogate || g_unichar_type(code) == G_UNICODE_UNASSIGNED) continue;
    std::array<char, 6> bytes{};
    const auto size = static_cast<std::size_t>(g_unichar_to_utf8(code, bytes.data()));
    const std::string character(bytes.data(), size);
    const std::string expected = MustBeHidden(code) ? "a?a" : "a" + character + "a";
    EXPECT_EQ(base::Printable("a" + character + "a"), expected) << std::hex << code;
    replaced += MustBeHidden(code) ? 1 : 0;
  }
  EXPECT_GT(replaced, 100'000) << "private use alone has so many characters";
}

}  // namespace
}  // namespace thunderhead::product
