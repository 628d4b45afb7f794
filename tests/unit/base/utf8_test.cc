#include "base/utf8.h"

#include <string>

#include "gtest/gtest.h"

namespace thunderhead::base {
namespace {

TEST(PrintableTest, KeepsTextOfAnyScript) {
  for (const std::string text :
       {"", "supercell", "Gewitter über Köln", "雷雨", "🌩 40 min", "\u00a0"}) {
    EXPECT_EQ(Printable(text), text);
  }
}

TEST(PrintableTest, ReplacesBytesThatAreNoUtf8) {
  EXPECT_EQ(Printable("a\xff"), "a?");
  EXPECT_EQ(Printable("\xc3"), "?");            // the first half of a character
  EXPECT_EQ(Printable("\xc0\xaf"), "??");       // an overlong encoding
  EXPECT_EQ(Printable("\xed\xa0\x80"), "???");  // a surrogate
}

TEST(PrintableTest, ReplacesWhatForgesLines) {
  EXPECT_EQ(Printable("storm\naudit time=now"), "storm?audit time=now");
  EXPECT_EQ(Printable(std::string("a\0b\r\t\x1b[31m\x7f", 11)), "a?b???[31m?");
  EXPECT_EQ(Printable("a\u0085b\u009fc"), "a?b?c");  // C1 control characters
  EXPECT_EQ(Printable("a\u2028b\u2029c"), "a?b?c");  // line and paragraph separators
  EXPECT_EQ(Printable("a\u202egpj.exe\u2066"),
            "a?gpj.exe?");  // characters that change the text direction
}

// The whole table is compared with Unicode's categories by PrintableCategories in product_test.
TEST(PrintableTest, ReplacesInvisibleCharacters) {
  for (const std::string hidden :
       {"\u200f", "\u061c", "\u200b", "\u2060", "\u00ad", "\u115f", "\u3164", "\ufeff",
        "\U000e0041", "\U000e0101", "\ue000", "\uffff", "\U0001fffe"}) {
    EXPECT_EQ(Printable("run" + hidden + "1"), "run?1");
    EXPECT_EQ(Printable("\u96e8" + hidden + "\u96e8"), "\u96e8?\u96e8");
  }
}

TEST(PrintableTest, KeepsJoinersOnlyWhereScriptsNeedThem) {
  for (const std::string text :
       {"\u0646\u200c\u0627",                                            // Persian
        "\u0915\u094d\u200d\u0937",                                      // Hindi
        "\u26c8\ufe0f", "\u26c8\ufe0e", "\u2764\ufe0f\u200d\U0001f525",  // emoji
        "e\u0301"}) {
    EXPECT_EQ(Printable(text), text);
  }
  EXPECT_EQ(Printable("run\u200d1"), "run?1");
  EXPECT_EQ(Printable("run\ufe0f"), "run?");
  EXPECT_EQ(Printable("\u96e8\u200d"), "\u96e8?");                     // nothing follows
  EXPECT_EQ(Printable("\u96e8\u200d1"), "\u96e8?1");                   // Latin follows
  EXPECT_EQ(Printable("\u200d\u96e8"), "?\u96e8");                     // nothing precedes
  EXPECT_EQ(Printable("\u96e8\u200d\u200d\u96e8"), "\u96e8??\u96e8");  // one after another
  EXPECT_EQ(Printable("\u96e8\ufe0f\ufe0f"), "\u96e8\ufe0f?");
  EXPECT_EQ(Printable("\u96e8\u200d\xff"), "\u96e8??");
}

TEST(PrintableTest, ShortensAtTheBoundaryOfACharacter) {
  EXPECT_EQ(Printable("abcdef", {.max_bytes = 6}), "abcdef");
  EXPECT_EQ(Printable("abcdefg", {.max_bytes = 6}), "abc\u2026");
  EXPECT_EQ(Printable("ab\u96e8def", {.max_bytes = 6}), "ab\u2026");
  EXPECT_EQ(Printable("abcdefg", {.max_bytes = 3}), "\u2026");
  const std::string shown = Printable(std::string(100'000, 'x'));
  EXPECT_EQ(shown, std::string(kMaxTextBytes - 3, 'x') + "\u2026");
  EXPECT_EQ(Printable(shown), shown);
}

TEST(PrintableTest, ReplacesByTheGivenCharacter) {
  EXPECT_EQ(Printable("a\u200fb\xff", {.instead = ' '}), "a b ");
}

}  // namespace
}  // namespace thunderhead::base
