#include "gl/program.h"

#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "base/status.h"
#include "gl/embedded_shaders.h"
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

absl::StatusOr<Shader> Compile(GLenum type, const std::string& path,
                               const std::vector<Define>& defines) {
  std::string text = "#version 450 core\n";
  for (const Define& define : defines) {
    absl::StrAppend(&text, "#define ", define.name, " ", define.value, "\n");
  }
  std::set<std::string> included;
  THUNDERHEAD_RETURN_IF_ERROR(AppendFile(path, &included, &text));
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

absl::StatusOr<Program> Program::Link(const ProgramSource& source) {
  Program program;
  program.name_ = Name<internal::DeleteProgram>(glCreateProgram());
  const GLuint name = program.name_.Get();
  std::vector<Shader> shaders;  // stay until the program is linked
  for (const auto& [type, path] : {std::pair{GL_VERTEX_SHADER, &source.vertex},
                                   std::pair{GL_FRAGMENT_SHADER, &source.fragment},
                                   std::pair{GL_COMPUTE_SHADER, &source.compute}}) {
    if (path->empty()) continue;
    THUNDERHEAD_ASSIGN_OR_RETURN(Shader shader,
                                 Compile(static_cast<GLenum>(type), *path, source.defines));
    glAttachShader(name, shader.Get());
    shaders.push_back(std::move(shader));
  }
  glLinkProgram(name);
  GLint linked = 0;
  glGetProgramiv(name, GL_LINK_STATUS, &linked);
  if (linked == GL_FALSE) {
    char log[4096];
    glGetProgramInfoLog(name, sizeof(log), nullptr, log);
    return absl::InternalError(absl::StrCat("program ", source.vertex, " ", source.fragment, " ",
                                            source.compute, " does not link: ", log));
  }
  program.locations_ = UniformLocations(name);
  return program;
}

GLint Program::Location(std::string_view uniform) const {
  const auto found = locations_.find(uniform);
  return found == locations_.end() ? -1 : found->second;
}

void Program::Set(std::string_view uniform, int value) const {
  glProgramUniform1i(name_.Get(), Location(uniform), value);
}
void Program::Set(std::string_view uniform, const glm::ivec3& value) const {
  glProgramUniform3iv(name_.Get(), Location(uniform), 1, glm::value_ptr(value));
}
void Program::Set(std::string_view uniform, float value) const {
  glProgramUniform1f(name_.Get(), Location(uniform), value);
}
void Program::Set(std::string_view uniform, const glm::vec2& value) const {
  glProgramUniform2fv(name_.Get(), Location(uniform), 1, glm::value_ptr(value));
}
void Program::Set(std::string_view uniform, const glm::vec3& value) const {
  glProgramUniform3fv(name_.Get(), Location(uniform), 1, glm::value_ptr(value));
}
void Program::Set(std::string_view uniform, const glm::vec4& value) const {
  glProgramUniform4fv(name_.Get(), Location(uniform), 1, glm::value_ptr(value));
}
void Program::Set(std::string_view uniform, const glm::mat3& value) const {
  glProgramUniformMatrix3fv(name_.Get(), Location(uniform), 1, GL_FALSE, glm::value_ptr(value));
}

void Program::Set(std::string_view uniform, const glm::mat4& value) const {
  glProgramUniformMatrix4fv(name_.Get(), Location(uniform), 1, GL_FALSE, glm::value_ptr(value));
}
void Program::Set(std::string_view uniform, const glm::mat4x3& value) const {
  glProgramUniformMatrix4x3fv(name_.Get(), Location(uniform), 1, GL_FALSE, glm::value_ptr(value));
}
void Program::Set(std::string_view uniform, const std::vector<float>& values) const {
  glProgramUniform1fv(name_.Get(), Location(uniform), static_cast<GLsizei>(values.size()),
                      values.data());
}
void Program::Set(std::string_view uniform, const std::vector<glm::vec2>& values) const {
  glProgramUniform2fv(name_.Get(), Location(uniform), static_cast<GLsizei>(values.size()),
                      glm::value_ptr(values.front()));
}
void Program::Set(std::string_view uniform, const std::vector<glm::vec3>& values) const {
  glProgramUniform3fv(name_.Get(), Location(uniform), static_cast<GLsizei>(values.size()),
                      glm::value_ptr(values.front()));
}
void Program::Set(std::string_view uniform, const std::vector<glm::vec4>& values) const {
  glProgramUniform4fv(name_.Get(), Location(uniform), static_cast<GLsizei>(values.size()),
                      glm::value_ptr(values.front()));
}

absl::StatusOr<const Program*> ProgramCache::Get(const ProgramSource& source) {
  auto found = programs_.find(source);
  if (found == programs_.end()) {
    THUNDERHEAD_ASSIGN_OR_RETURN(Program program, Program::Link(source));
    found = programs_.emplace(source, std::move(program)).first;
  }
  return &found->second;
}

}  // namespace thunderhead::gl
