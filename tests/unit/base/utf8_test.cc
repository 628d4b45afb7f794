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

}  // namespace
}  // namespace thunderhead::base
