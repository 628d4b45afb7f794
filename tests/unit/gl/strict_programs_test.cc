#include "gl/strict_programs.h"

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace thunderhead::gl {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(DeclaredUniforms, AreThoseOfAllVariants) {
  EXPECT_THAT(DeclaredUniforms("uniform vec3 tint;  // of light; of air\n"
                               "#if TERRAIN\n"
                               "layout(binding = 3) uniform sampler2D terrain;\n"
                               "#endif\n"
                               "uniform vec4 weights[PLANES * 2];\n"
                               "// uniform float commented;\n"
                               "flat in vec3 middle_m;\n"
                               "void main() { color = tint; }\n"),
              ElementsAre("terrain", "tint", "weights"));
}

TEST(CheckDefines, TakesDefinesThatAStageMentions) {
  EXPECT_TRUE(CheckDefines({"#if FRONT_FIRST\n#endif\n", "int colored = COLORED;\n"},
                           {{"FRONT_FIRST", 1}, {"COLORED", 0}})
                  .ok());
}

TEST(CheckDefines, NamesADefineThatNoShaderMentions) {
  const absl::Status status = CheckDefines({"// Variants: COLOURED\n#if COLORED\n#endif\n"},
                                           {{"COLORED", 0}, {"COLOURED", 1}});
  EXPECT_EQ(status.code(), absl::StatusCode::kInternal);
  EXPECT_THAT(std::string(status.message()), HasSubstr("COLOURED"));
}

TEST(CheckDefines, NamesAMacroOfAConditionThatNobodyDefines) {
  const Defines defines = {{"COLORED", 0}};
  const absl::Status status =
      CheckDefines({"#if COLORED\n#elif COLORED == 0 && TINTED\n#endif\n"}, defines);
  EXPECT_THAT(std::string(status.message()), HasSubstr("TINTED"));
  EXPECT_TRUE(CheckDefines({"#define TINTED (2 * COLORED)\n#if TINTED\n#endif\n"}, defines).ok());
  EXPECT_TRUE(CheckDefines({"#ifdef __cplusplus\n#endif\n#if COLORED\n#endif\n"}, defines).ok());
}

}  // namespace
}  // namespace thunderhead::gl
