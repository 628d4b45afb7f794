#include "gl/program.h"

#include <type_traits>

#include "gl/strict_programs.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "shaders/uniforms.h"
#include "tests/support/gl_context.h"

namespace thunderhead::gl {
namespace {

using testing::HasSubstr;

// A variant that lacks a macro, or a uniform value of another type, does not compile.
static_assert(!std::is_default_constructible_v<DefineValue>);
template <typename T>
concept IsGain = requires(const Program& program, const T& value) {
  program.Set(uniform::gain, value);
};
static_assert(IsGain<glm::vec3> && !IsGain<glm::dvec3> && !IsGain<float>);

TEST(Program, NamesAMissingShader) {
  const auto context = test_support::OpenContext();
  ASSERT_TRUE(context.ok());
  const auto program = Program::Link(ProgramSource::WholeTarget("common/nowhere.frag"));
  ASSERT_FALSE(program.ok());
  EXPECT_THAT(std::string(program.status().message()), HasSubstr("common/nowhere.frag"));
}

TEST(Program, FailsWhenAUniformIsSetThatItsShadersDoNotDeclare) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto context = test_support::OpenContext();
  ASSERT_TRUE(context.ok());
  const auto program = Program::Link(
      ProgramSource::WholeTarget("post/tone_map.frag", {{"FILMIC", 0}, {"NOISE", 0}}));
  ASSERT_TRUE(program.ok()) << program.status();
  program->Set(uniform::gain, glm::vec3(1.0F));
  EXPECT_DEATH(program->Set(Uniform<float>{"gian"}, 1.0F),
               "post/tone_map.frag has no uniform gian");
}

TEST(Program, NamesADefineThatItsShadersDoNotMention) {
  const auto context = test_support::OpenContext();
  ASSERT_TRUE(context.ok());
  const auto program = Program::Link(ProgramSource::WholeTarget(
      "post/tone_map.frag", {{"FILMIC", 0}, {"FILMICK", 1}, {"NOISE", 0}}));
  ASSERT_FALSE(program.ok());
  EXPECT_THAT(std::string(program.status().message()), HasSubstr("tone_map.frag"));
  EXPECT_THAT(std::string(program.status().message()), HasSubstr("FILMICK"));
}

// Returns a compute program with `declarations` that stores the value of `used`.
GLuint Computing(const std::string& declarations, const std::string& used) {
  const std::string text = "#version 450 core\nlayout(local_size_x = 1) in;\n" + declarations +
                           "layout(binding = 7, r32f) uniform writeonly image2D result;\n"
                           "void main() { imageStore(result, ivec2(0), vec4(" +
                           used + ")); }\n";
  const char* source = text.c_str();
  const GLuint program = glCreateShaderProgramv(GL_COMPUTE_SHADER, 1, &source);
  GLint linked = 0;
  glGetProgramiv(program, GL_LINK_STATUS, &linked);
  EXPECT_EQ(linked, GL_TRUE);
  return program;
}

TEST(CheckBindings, TakesDifferentKindsWithTheSameBinding) {
  const auto context = test_support::OpenContext();
  ASSERT_TRUE(context.ok());
  const absl::Status status = CheckBindings(
      Computing("layout(binding = 0) uniform sampler2D light;\n"
                "layout(binding = 1) uniform sampler2D thickness;\n"
                "layout(binding = 0, r32f) uniform readonly image2D before;\n"
                "layout(std430, binding = 0) readonly buffer Balls { float balls[]; };\n",
                "texture(light, vec2(0)) + texture(thickness, vec2(0)) + balls[0] + "
                "imageLoad(before, ivec2(0))"));
  EXPECT_TRUE(status.ok()) << status;
}

TEST(CheckBindings, NamesWhatSharesABinding) {
  const auto context = test_support::OpenContext();
  ASSERT_TRUE(context.ok());
  const auto message = [](const std::string& declarations, const std::string& used) {
    return std::string(CheckBindings(Computing(declarations, used)).message());
  };
  // An array takes as many bindings as it has elements.
  EXPECT_THAT(message("layout(binding = 4) uniform sampler2D noise[3];\n"
                      "layout(binding = 6) uniform sampler3D light;\n",
                      "texture(noise[0], vec2(0)) + texture(noise[2], vec2(0)) + "
                      "texture(light, vec3(0))"),
              AllOf(HasSubstr("light"), HasSubstr("noise"), HasSubstr("binding 6")));
  EXPECT_THAT(message("layout(binding = 7, r32f) uniform readonly image2D before;\n",
                      "imageLoad(before, ivec2(0))"),
              AllOf(HasSubstr("images"), HasSubstr("before"), HasSubstr("result")));
  EXPECT_THAT(message("layout(std430, binding = 2) readonly buffer Balls { float balls[]; };\n"
                      "layout(std430, binding = 2) readonly buffer Order { float order[]; };\n",
                      "balls[0] + order[0]"),
              AllOf(HasSubstr("storage"), HasSubstr("Balls"), HasSubstr("Order")));
}

}  // namespace
}  // namespace thunderhead::gl
