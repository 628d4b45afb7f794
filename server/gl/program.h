// Shader programs and their variants. Sources are the embedded shader files, which can include each
// other by `#include "path"`. This code does not use physics.
#pragma once

#include <epoxy/gl.h>

#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "gl/objects.h"
#include "gl/pieces.h"
#include "glm/mat3x3.hpp"
#include "glm/mat4x3.hpp"
#include "glm/mat4x4.hpp"
#include "glm/vec2.hpp"
#include "glm/vec3.hpp"
#include "glm/vec4.hpp"

namespace thunderhead::gl {

namespace internal {
void DeleteProgram(GLuint name);
}  // namespace internal

// A macro for the preprocessor: its name and value.
struct Define {
  std::string name;
  int value = 0;

  auto operator<=>(const Define&) const = default;
};

using Defines = std::vector<Define>;

Defines Joined(Defines first, const Defines& more);

// The value of a macro in a struct that describes a shader's variant. The type has no default
// value. A variant that omits a macro therefore does not compile.
class DefineValue {
 public:
  DefineValue(int value) : value_(value) {}  // NOLINT(google-explicit-constructor)
  operator int() const { return value_; }    // NOLINT(google-explicit-constructor)

 private:
  int value_;
};

// The shader files and the macros of a program. A program has a vertex and a fragment shader, or
// only a compute shader.
struct ProgramSource {
  std::string vertex;    // e.g. "cumulus/bubble.vert"
  std::string fragment;  // e.g. "half_angle/eye.frag"
  std::string compute;   // e.g. "light_volume/carry.comp"
  Defines defines;
  // The fragment shader may run as a compute shader: gl/computed_target.h.
  bool whole_target = false;

  static ProgramSource Of(std::string vertex, std::string fragment, Defines defines = {});
  // Create sources for gl::WholeTarget. Use BlendedWholeTarget if drawing blends.
  static ProgramSource WholeTarget(std::string fragment, Defines defines = {});
  static ProgramSource BlendedWholeTarget(std::string fragment, Defines defines = {});
  static ProgramSource Compute(std::string compute, Defines defines = {});

  auto operator<=>(const ProgramSource&) const = default;
};

// The name of a uniform with a value of type T, or of an array if T is an array type. The shaders'
// uniforms are generated in shaders/uniforms.h.
template <typename T>
struct Uniform {
  std::string_view name;
};

// A linked program. Set does nothing if the program's variant does not have the uniform. If
// programs are strict (gl/strict_programs.h), Set aborts the process for a uniform that no variant
// has.
class Program {
 public:
  static absl::StatusOr<Program> Link(const ProgramSource& source);
  // Links a program whose source is a whole target. If `computes` is true, it becomes a compute
  // shader.
  static absl::StatusOr<Program> LinkWholeTarget(const ProgramSource& source, bool computes);

  void Use() const { glUseProgram(name_.Get()); }
  // Returns true if the program draws a whole target with a compute shader.
  bool Computes() const { return computes_; }
  GLuint Get() const { return name_.Get(); }
  template <typename T>
  void Set(Uniform<T> uniform, const T& value) const {
    SetAt(Location(uniform.name), value);
  }
  template <typename T>
  void Set(Uniform<T[]> uniform, const std::vector<T>& values) const {
    SetAt(Location(uniform.name), values);
  }

 private:
  // Data for the checks of gl/strict_programs.h, kept only if programs are strict.
  struct Strict {
    std::string paths;
    std::set<std::string, std::less<>> uniforms;
  };

  static absl::StatusOr<Program> LinkFiles(const ProgramSource& source, bool computes);
  absl::Status BecomeStrict(const ProgramSource& source, const std::vector<std::string>& texts);
  GLint Location(std::string_view uniform) const;
  void SetAt(GLint location, bool value) const;
  void SetAt(GLint location, int value) const;
  void SetAt(GLint location, const glm::ivec2& value) const;
  void SetAt(GLint location, const glm::ivec3& value) const;
  void SetAt(GLint location, float value) const;
  void SetAt(GLint location, const glm::vec2& value) const;
  void SetAt(GLint location, const glm::vec3& value) const;
  void SetAt(GLint location, const glm::vec4& value) const;
  void SetAt(GLint location, const glm::mat3& value) const;
  void SetAt(GLint location, const glm::mat4& value) const;
  void SetAt(GLint location, const glm::mat4x3& value) const;
  void SetAt(GLint location, const std::vector<float>& values) const;
  void SetAt(GLint location, const std::vector<glm::vec2>& values) const;
  void SetAt(GLint location, const std::vector<glm::vec3>& values) const;
  void SetAt(GLint location, const std::vector<glm::vec4>& values) const;

  Name<internal::DeleteProgram> name_;
  std::map<std::string, GLint, std::less<>> locations_;
  bool computes_ = false;
  std::optional<Strict> strict_;
};

// A context's linked programs by source, and the pieces (gl/pieces.h) in which they draw. Programs
// are linked on first use.
class ProgramCache {
 public:
  ProgramCache() = default;
  // Takes `turn` for each piece of drawing. `turn` must outlive this object.
  explicit ProgramCache(base::DeviceTurn* turn) : pieces_(turn) {}

  gl::Pieces& Pieces() { return pieces_; }

  // Returns the program of `source`. The pointer is valid as long as the cache. Returns INTERNAL
  // with the compiler's log if the program does not compile or link.
  absl::StatusOr<const Program*> Get(const ProgramSource& source);

 private:
  gl::Pieces pieces_;
  std::map<ProgramSource, Program> programs_;
};

}  // namespace thunderhead::gl
