#include "gl/program.h"

#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "base/status.h"
#include "gl/computed_target.h"
#include "gl/device.h"
#include "gl/embedded_shaders.h"
#include "gl/flat_uniforms.h"
#include "gl/strict_programs.h"
#include "gl/whole_target.h"
#include "glm/gtc/type_ptr.hpp"

namespace thunderhead::gl {
namespace internal {

void DeleteProgram(GLuint name) { glDeleteProgram(name); }
void DeleteShader(GLuint name) { glDeleteShader(name); }

}  // namespace internal

namespace {

using Shader = Name<internal::DeleteShader>;

absl::Status AppendFile(const std::string& path, std::set<std::string>* included,
                        std::string* text) {
  if (!included->insert(path).second) return absl::OkStatus();
  const auto found = EmbeddedShaders().find(path);
  if (found == EmbeddedShaders().end()) {
    return absl::InternalError(absl::StrCat("no shader file ", path));
  }
  const absl::string_view body(found->second.data(), found->second.size());
  int line = 0;
  absl::StrAppend(text, "#line 1\n");
  for (absl::string_view row : absl::StrSplit(body, '\n')) {
    ++line;
    absl::string_view rest = row;
    if (absl::ConsumePrefix(&rest, "#include \"") && absl::ConsumeSuffix(&rest, "\"")) {
      THUNDERHEAD_RETURN_IF_ERROR(AppendFile(std::string(rest), included, text));
      absl::StrAppend(text, "#line ", line + 1, "\n");
    } else {
      absl::StrAppend(text, row, "\n");
    }
  }
  return absl::OkStatus();
}

absl::StatusOr<std::string> TextOf(const std::string& path) {
  std::string text;
  std::set<std::string> included;
  THUNDERHEAD_RETURN_IF_ERROR(AppendFile(path, &included, &text));
  return text;
}

// Returns the text of a compute shader that draws each pixel of a whole target with the code of
// `fragment`.
absl::StatusOr<std::string> ComputedTextOf(const std::string& fragment) {
  std::string text;
  std::set<std::string> included;
  THUNDERHEAD_RETURN_IF_ERROR(AppendFile("common/bindings.glsl", &included, &text));
  THUNDERHEAD_RETURN_IF_ERROR(AppendFile(fragment, &included, &text));
  std::string rest;
  THUNDERHEAD_RETURN_IF_ERROR(AppendFile("common/whole_target.glsl", &included, &rest));
  return absl::StrCat(AsComputedPixel(text), rest);
}

std::string WithDefines(const std::string& text, const Defines& defines) {
  std::string head = "#version 450 core\n";
  for (const Define& define : defines) {
    absl::StrAppend(&head, "#define ", define.name, " ", define.value, "\n");
  }
  return head + text;
}

absl::StatusOr<Shader> Compile(GLenum type, const std::string& path, const std::string& text) {
  Shader shader(glCreateShader(type));
  const char* source = text.c_str();
  glShaderSource(shader.Get(), 1, &source, nullptr);
  glCompileShader(shader.Get());
  GLint compiled = 0;
  glGetShaderiv(shader.Get(), GL_COMPILE_STATUS, &compiled);
  if (compiled == GL_FALSE) {
    std::string log(4096, '\0');
    GLsizei length = 0;
    glGetShaderInfoLog(shader.Get(), static_cast<GLsizei>(log.size()), &length, log.data());
    log.resize(static_cast<std::size_t>(length));
    return absl::InternalError(absl::StrCat("shader ", path, " does not compile: ", log));
  }
  return shader;
}

// Links a program from `texts`, one shader stage each. `paths` appear in error messages.
absl::StatusOr<Name<internal::DeleteProgram>> LinkTexts(
    const std::vector<std::pair<GLenum, std::string>>& texts,
    const std::vector<std::string>& paths) {
  Name<internal::DeleteProgram> program(glCreateProgram());
  std::vector<Shader> shaders;  // must live until the program is linked
  for (std::size_t i = 0; i < texts.size(); ++i) {
    THUNDERHEAD_ASSIGN_OR_RETURN(Shader shader, Compile(texts[i].first, paths[i], texts[i].second));
    glAttachShader(program.Get(), shader.Get());
    shaders.push_back(std::move(shader));
  }
  glLinkProgram(program.Get());
  GLint linked = 0;
  glGetProgramiv(program.Get(), GL_LINK_STATUS, &linked);
  if (linked == GL_FALSE) {
    char log[4096];
    glGetProgramInfoLog(program.Get(), sizeof(log), nullptr, log);
    return absl::InternalError(
        absl::StrCat("program ", absl::StrJoin(paths, " "), " does not link: ", log));
  }
  return program;
}

std::vector<std::string> PathsOf(const ProgramSource& source) {
  if (!source.compute.empty()) return {source.compute};
  return {source.vertex, source.fragment};
}

// Links the stages of `source`. `texts` are the texts of the files PathsOf(source).
absl::StatusOr<Name<internal::DeleteProgram>> LinkStages(const ProgramSource& source,
                                                         const std::vector<std::string>& texts) {
  if (!source.compute.empty()) {
    return LinkTexts({{GL_COMPUTE_SHADER, WithDefines(texts[0], source.defines)}}, PathsOf(source));
  }
  const StageTexts stages{WithDefines(texts[0], source.defines),
                          WithDefines(texts[1], source.defines)};
  const auto link = [&](const StageTexts& of) {
    return LinkTexts({{GL_VERTEX_SHADER, of.vertex}, {GL_FRAGMENT_SHADER, of.fragment}},
                     PathsOf(source));
  };
  if (DrawsInSoftware()) {
    // If the device has fewer inputs than there are uniforms, linking fails. Then the uniforms stay
    // uniforms.
    auto program = link(WithFlatUniforms(stages));
    if (program.ok()) return program;
  }
  return link(stages);
}

std::map<std::string, GLint, std::less<>> UniformLocations(GLuint program) {
  std::map<std::string, GLint, std::less<>> locations;
  GLint count = 0;
  glGetProgramiv(program, GL_ACTIVE_UNIFORMS, &count);
  for (GLint i = 0; i < count; ++i) {
    char name[256];
    GLsizei length = 0;
    GLint size = 0;
    GLenum type = 0;
    glGetActiveUniform(program, static_cast<GLuint>(i), sizeof(name), &length, &size, &type, name);
    const GLint location = glGetUniformLocation(program, name);
    absl::string_view key(name, static_cast<std::size_t>(length));
    absl::ConsumeSuffix(&key, "[0]");
    locations.emplace(std::string(key), location);
  }
  return locations;
}

}  // namespace

Defines Joined(Defines first, const Defines& more) {
  first.insert(first.end(), more.begin(), more.end());
  return first;
}

ProgramSource ProgramSource::Of(std::string vertex, std::string fragment, Defines defines) {
  return {std::move(vertex), std::move(fragment), "", std::move(defines), false};
}

ProgramSource ProgramSource::WholeTarget(std::string fragment, Defines defines) {
  ProgramSource source = BlendedWholeTarget(std::move(fragment), std::move(defines));
  source.whole_target = true;
  return source;
}

ProgramSource ProgramSource::BlendedWholeTarget(std::string fragment, Defines defines) {
  return Of("common/whole_target.vert", std::move(fragment), std::move(defines));
}

ProgramSource ProgramSource::Compute(std::string compute, Defines defines) {
  return {"", "", std::move(compute), std::move(defines), false};
}

absl::StatusOr<Program> Program::Link(const ProgramSource& source) {
  return LinkFiles(source, source.whole_target && ComputesWholeTargets());
}

absl::StatusOr<Program> Program::LinkWholeTarget(const ProgramSource& source, bool computes) {
  return LinkFiles(source, computes);
}

absl::StatusOr<Program> Program::LinkFiles(const ProgramSource& source, bool computes) {
  Program program;
  program.computes_ = computes;
  std::vector<std::string> texts;
  if (computes) {
    THUNDERHEAD_ASSIGN_OR_RETURN(texts.emplace_back(), ComputedTextOf(source.fragment));
    THUNDERHEAD_ASSIGN_OR_RETURN(
        program.name_,
        LinkTexts({{GL_COMPUTE_SHADER, WithDefines(texts[0], source.defines)}}, {source.fragment}));
  } else {
    for (const std::string& path : PathsOf(source)) {
      THUNDERHEAD_ASSIGN_OR_RETURN(texts.emplace_back(), TextOf(path));
    }
    THUNDERHEAD_ASSIGN_OR_RETURN(program.name_, LinkStages(source, texts));
  }
  program.locations_ = UniformLocations(program.name_.Get());
  if (StrictPrograms()) THUNDERHEAD_RETURN_IF_ERROR(program.BecomeStrict(source, texts));
  return program;
}

absl::Status Program::BecomeStrict(const ProgramSource& source,
                                   const std::vector<std::string>& texts) {
  strict_.emplace();
  strict_->paths = absl::StrJoin(PathsOf(source), " ");
  for (const std::string& text : texts) strict_->uniforms.merge(DeclaredUniforms(text));
  absl::Status checked = CheckDefines(texts, source.defines);
  checked.Update(CheckBindings(name_.Get()));
  return base::Annotate(checked, strict_->paths);
}

GLint Program::Location(std::string_view uniform) const {
  const auto found = locations_.find(uniform);
  if (found != locations_.end()) return found->second;
  if (strict_.has_value()) {
    THUNDERHEAD_CHECK(strict_->uniforms.contains(uniform),
                      absl::StrCat(strict_->paths, " has no uniform ", std::string(uniform)));
  }
  return -1;
}

void Program::SetAt(GLint location, bool value) const { SetAt(location, value ? 1 : 0); }
void Program::SetAt(GLint location, int value) const {
  glProgramUniform1i(name_.Get(), location, value);
}
void Program::SetAt(GLint location, const glm::ivec2& value) const {
  glProgramUniform2iv(name_.Get(), location, 1, glm::value_ptr(value));
}
void Program::SetAt(GLint location, const glm::ivec3& value) const {
  glProgramUniform3iv(name_.Get(), location, 1, glm::value_ptr(value));
}
void Program::SetAt(GLint location, float value) const {
  glProgramUniform1f(name_.Get(), location, value);
}
void Program::SetAt(GLint location, const glm::vec2& value) const {
  glProgramUniform2fv(name_.Get(), location, 1, glm::value_ptr(value));
}
void Program::SetAt(GLint location, const glm::vec3& value) const {
  glProgramUniform3fv(name_.Get(), location, 1, glm::value_ptr(value));
}
void Program::SetAt(GLint location, const glm::vec4& value) const {
  glProgramUniform4fv(name_.Get(), location, 1, glm::value_ptr(value));
}
void Program::SetAt(GLint location, const glm::mat3& value) const {
  glProgramUniformMatrix3fv(name_.Get(), location, 1, GL_FALSE, glm::value_ptr(value));
}

void Program::SetAt(GLint location, const glm::mat4& value) const {
  glProgramUniformMatrix4fv(name_.Get(), location, 1, GL_FALSE, glm::value_ptr(value));
}
void Program::SetAt(GLint location, const glm::mat4x3& value) const {
  glProgramUniformMatrix4x3fv(name_.Get(), location, 1, GL_FALSE, glm::value_ptr(value));
}
void Program::SetAt(GLint location, const std::vector<float>& values) const {
  glProgramUniform1fv(name_.Get(), location, static_cast<GLsizei>(values.size()), values.data());
}
void Program::SetAt(GLint location, const std::vector<glm::vec2>& values) const {
  glProgramUniform2fv(name_.Get(), location, static_cast<GLsizei>(values.size()),
                      glm::value_ptr(values.front()));
}
void Program::SetAt(GLint location, const std::vector<glm::vec3>& values) const {
  glProgramUniform3fv(name_.Get(), location, static_cast<GLsizei>(values.size()),
                      glm::value_ptr(values.front()));
}
void Program::SetAt(GLint location, const std::vector<glm::vec4>& values) const {
  glProgramUniform4fv(name_.Get(), location, static_cast<GLsizei>(values.size()),
                      glm::value_ptr(values.front()));
}

absl::StatusOr<const Program*> ProgramCache::Get(const ProgramSource& source) {
  auto found = programs_.find(source);
  if (found == programs_.end()) {
    absl::StatusOr<Program> program;
    THUNDERHEAD_RETURN_IF_ERROR(pieces_.OffTurn([&] { program = Program::Link(source); }));
    THUNDERHEAD_RETURN_IF_ERROR(program.status());
    found = programs_.emplace(source, *std::move(program)).first;
  }
  return &found->second;
}

}  // namespace thunderhead::gl
