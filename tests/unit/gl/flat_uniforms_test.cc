#include "gl/flat_uniforms.h"

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace thunderhead::gl {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr char kVertex[] =
    "#version 450 core\n"
    "uniform mat4 clip;\n"
    "in vec3 corner;\n"
    "void main() { gl_Position = clip * vec4(corner, 1.0); }\n";

StageTexts Flat(const std::string& fragment) {
  return WithFlatUniforms({kVertex, "#version 450 core\n" + fragment});
}

TEST(FlatUniforms, AreHandedOnByTheVertexShader) {
  const StageTexts texts =
      Flat("uniform vec3 tint;  // of the air\nvoid main() { color = tint; }\n");
  EXPECT_THAT(texts.vertex, HasSubstr("uniform vec3 tint;\nflat out vec3 flat_tint;\n"));
  EXPECT_THAT(texts.vertex, HasSubstr("void main() {\nplace_vertex();\nflat_tint = tint;\n}"));
  EXPECT_THAT(texts.vertex, HasSubstr("void place_vertex() { gl_Position"));
  EXPECT_THAT(texts.fragment, HasSubstr("flat in vec3 flat_tint;\n#define tint flat_tint\n"));
  EXPECT_THAT(texts.fragment, Not(HasSubstr("uniform")));
}

TEST(FlatUniforms, KeepConditionsAndSizes) {
  const StageTexts texts = Flat(
      "#define PLANES 2\n"
      "#if COLORED\n"
      "uniform vec4 weights[PLANES];\n"
      "#endif\n"
      "void main() {}\n");
  EXPECT_THAT(texts.vertex,
              HasSubstr("#define PLANES 2\n#if COLORED\nuniform vec4 weights[PLANES];\n"
                        "flat out vec4 flat_weights[PLANES];\n#endif\n"));
  EXPECT_THAT(texts.vertex,
              HasSubstr("place_vertex();\n#if COLORED\nflat_weights = weights;\n#endif\n}"));
}

TEST(FlatUniforms, OfBothStagesAreDeclaredOnce) {
  const StageTexts texts = Flat("uniform mat4 clip;\nvoid main() { color = clip[0].rgb; }\n");
  EXPECT_THAT(texts.vertex, HasSubstr("flat out mat4 flat_clip;\nvoid main() {"));
  EXPECT_EQ(texts.vertex.find("uniform mat4 clip;"), texts.vertex.rfind("uniform mat4 clip;"));
}

TEST(FlatUniforms, LeaveSamplersAndSwitches) {
  const std::string fragment =
      "layout(binding = 3) uniform sampler2D light;\n"
      "uniform bool shaded;\n"
      "void main() {}\n";
  const StageTexts texts = Flat(fragment);
  EXPECT_THAT(texts.fragment, HasSubstr(fragment));
  EXPECT_THAT(texts.vertex, Not(HasSubstr("flat")));
}

}  // namespace
}  // namespace thunderhead::gl
