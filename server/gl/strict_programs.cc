#include "gl/strict_programs.h"

#include <cstdlib>
#include <functional>
#include <map>
#include <string_view>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"

namespace thunderhead::gl {
namespace {

absl::string_view WithoutComment(absl::string_view row) { return row.substr(0, row.find("//")); }

bool IsWordCharacter(char c) {
  return absl::ascii_isalnum(static_cast<unsigned char>(c)) || c == '_';
}

void ForEachWord(absl::string_view row, const std::function<void(absl::string_view)>& use) {
  for (std::size_t i = 0; i < row.size();) {
    std::size_t end = i;
    while (end < row.size() && IsWordCharacter(row[end])) ++end;
    if (end > i && !absl::ascii_isdigit(static_cast<unsigned char>(row[i]))) {
      use(row.substr(i, end - i));
    }
    i = end + 1;
  }
}

std::vector<std::string> WordsOf(absl::string_view row) {
  std::vector<std::string> words;
  ForEachWord(row, [&](absl::string_view word) { words.emplace_back(word); });
  return words;
}

// The bindings of one kind of resource, with the name of the variable that uses each binding.
class Bindings {
 public:
  explicit Bindings(std::string kind) : kind_(std::move(kind)) {}

  absl::Status Take(GLint binding, const std::string& name) {
    const auto [taken, is_new] = names_.emplace(binding, name);
    if (is_new) return absl::OkStatus();
    return absl::InternalError(
        absl::StrCat(kind_, " ", taken->second, " and ", name, " both have binding ", binding));
  }

 private:
  std::string kind_;
  std::map<GLint, std::string> names_;
};

enum class Kind { kValue, kSampler, kImage };

Kind KindOf(GLenum type) {
  switch (type) {
    case GL_SAMPLER_2D:
    case GL_SAMPLER_3D:
    case GL_SAMPLER_2D_ARRAY:
    case GL_UNSIGNED_INT_SAMPLER_3D:
      return Kind::kSampler;
    case GL_IMAGE_2D:
    case GL_IMAGE_3D:
    case GL_IMAGE_2D_ARRAY:
      return Kind::kImage;
    default:
      return Kind::kValue;
  }
}

absl::Status CheckUniformBindings(GLuint program) {
  Bindings samplers("samplers");
  Bindings images("images");
  GLint count = 0;
  glGetProgramiv(program, GL_ACTIVE_UNIFORMS, &count);
  for (GLint i = 0; i < count; ++i) {
    char name[256];
    GLint size = 0;
    GLenum type = 0;
    glGetActiveUniform(program, static_cast<GLuint>(i), sizeof(name), nullptr, &size, &type, name);
    const Kind kind = KindOf(type);
    if (kind == Kind::kValue) continue;
    GLint binding = 0;
    glGetUniformiv(program, glGetUniformLocation(program, name), &binding);
    for (GLint element = 0; element < size; ++element) {
      absl::Status taken =
          (kind == Kind::kSampler ? samplers : images).Take(binding + element, name);
      if (!taken.ok()) return taken;
    }
  }
  return absl::OkStatus();
}

absl::Status CheckStorageBindings(GLuint program) {
  Bindings buffers("storage buffers");
  GLint count = 0;
  glGetProgramInterfaceiv(program, GL_SHADER_STORAGE_BLOCK, GL_ACTIVE_RESOURCES, &count);
  for (GLint i = 0; i < count; ++i) {
    const auto index = static_cast<GLuint>(i);
    char name[256];
    glGetProgramResourceName(program, GL_SHADER_STORAGE_BLOCK, index, sizeof(name), nullptr, name);
    const GLenum property = GL_BUFFER_BINDING;
    GLint binding = 0;
    glGetProgramResourceiv(program, GL_SHADER_STORAGE_BLOCK, index, 1, &property, 1, nullptr,
                           &binding);
    absl::Status taken = buffers.Take(binding, name);
    if (!taken.ok()) return taken;
  }
  return absl::OkStatus();
}

}  // namespace

bool StrictPrograms() {
  static const bool strict = [] {
    const char* value = std::getenv("THUNDERHEAD_STRICT_PROGRAMS");
    return value != nullptr && std::string_view(value) == "1";
  }();
  return strict;
}

std::set<std::string, std::less<>> DeclaredUniforms(const std::string& text) {
  std::set<std::string, std::less<>> names;
  for (const absl::string_view row : absl::StrSplit(text, '\n')) {
    const std::size_t end = row.find(';');
    if (end == absl::string_view::npos) continue;
    const absl::string_view declaration = row.substr(0, std::min(end, row.find('[')));
    const std::vector<std::string> words = WordsOf(declaration);
    const bool declares =
        absl::StartsWith(row, "uniform ") ||
        (absl::StartsWith(row, "layout(") && absl::StrContains(declaration, " uniform "));
    if (declares) names.insert(words.back());
  }
  return names;
}

absl::Status CheckDefines(const std::vector<std::string>& texts, const Defines& defines) {
  std::set<std::string, std::less<>> mentioned;
  std::set<std::string, std::less<>> from_outside = {"defined"};
  for (const Define& define : defines) from_outside.insert(define.name);
  for (const std::string& text : texts) {
    std::set<std::string, std::less<>> defined = from_outside;
    for (absl::string_view row : absl::StrSplit(text, '\n')) {
      row = WithoutComment(row);
      const std::vector<std::string> words = WordsOf(row);
      mentioned.insert(words.begin(), words.end());
      if (absl::StartsWith(row, "#define ")) defined.insert(words.at(1));
      if (!absl::StartsWith(row, "#if ") && !absl::StartsWith(row, "#elif ")) continue;
      for (auto word = words.begin() + 1; word != words.end(); ++word) {
        if (defined.contains(*word)) continue;
        return absl::InternalError(absl::StrCat("no define gives ", *word, " for ", row));
      }
    }
  }
  for (const Define& define : defines) {
    if (mentioned.contains(define.name)) continue;
    return absl::InternalError(absl::StrCat("no shader mentions the define ", define.name));
  }
  return absl::OkStatus();
}

absl::Status CheckBindings(GLuint program) {
  const absl::Status uniforms = CheckUniformBindings(program);
  return uniforms.ok() ? CheckStorageBindings(program) : uniforms;
}

}  // namespace thunderhead::gl
