#include "gl/flat_uniforms.h"

#include <algorithm>
#include <array>
#include <optional>
#include <set>
#include <string_view>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"

namespace thunderhead::gl {
namespace {

struct Declaration {
  std::string type;
  std::string name;
  std::string size;  // "[SIZE]" for an array, otherwise empty
};

// Returns the uniform that `row` declares, or nothing if it declares none that can be passed on as
// a flat input.
std::optional<Declaration> UniformIn(absl::string_view row) {
  constexpr std::array<std::string_view, 10> kTypes = {"float", "vec2",  "vec3",  "vec4", "int",
                                                       "ivec2", "ivec3", "ivec4", "mat3", "mat4"};
  if (!absl::ConsumePrefix(&row, "uniform ")) return std::nullopt;
  const std::size_t end = row.find(';');
  const std::size_t space = row.find(' ');
  if (end == absl::string_view::npos || space > end) return std::nullopt;
  Declaration declared{std::string(row.substr(0, space)), "", ""};
  if (std::find(kTypes.begin(), kTypes.end(), declared.type) == kTypes.end()) return std::nullopt;
  const absl::string_view rest = row.substr(space + 1, end - space - 1);
  const std::size_t bracket = std::min(rest.find('['), rest.size());
  declared.name = std::string(rest.substr(0, bracket));
  declared.size = std::string(rest.substr(bracket));
  return declared;
}

bool IsCondition(absl::string_view row) {
  return absl::StartsWith(row, "#if") || absl::StartsWith(row, "#el") ||
         absl::StartsWith(row, "#endif");
}

}  // namespace

StageTexts WithFlatUniforms(const StageTexts& texts) {
  std::set<std::string> in_vertex;
  for (const absl::string_view row : absl::StrSplit(texts.vertex, '\n')) {
    if (const std::optional<Declaration> found = UniformIn(row)) in_vertex.insert(found->name);
  }
  StageTexts flat;
  // Declarations for the vertex shader, under the same preprocessor conditions as in the fragment
  // shader.
  std::string declarations;
  std::string assignments;
  for (const absl::string_view row : absl::StrSplit(texts.fragment, '\n')) {
    const std::optional<Declaration> uniform = UniformIn(row);
    if (!uniform.has_value()) {
      absl::StrAppend(&flat.fragment, row, "\n");
      if (absl::StartsWith(row, "#version") || absl::StartsWith(row, "#line")) continue;
      if (absl::StartsWith(row, "#")) absl::StrAppend(&declarations, row, "\n");
      if (IsCondition(row)) absl::StrAppend(&assignments, row, "\n");
      continue;
    }
    const std::string whole = absl::StrCat(uniform->type, " flat_", uniform->name, uniform->size);
    absl::StrAppend(&flat.fragment, "flat in ", whole, ";\n#define ", uniform->name, " flat_",
                    uniform->name, "\n");
    if (!in_vertex.contains(uniform->name)) {
      absl::StrAppend(&declarations, "uniform ", uniform->type, " ", uniform->name, uniform->size,
                      ";\n");
    }
    absl::StrAppend(&declarations, "flat out ", whole, ";\n");
    absl::StrAppend(&assignments, "flat_", uniform->name, " = ", uniform->name, ";\n");
  }
  flat.vertex =
      absl::StrCat(absl::StrReplaceAll(texts.vertex, {{"void main()", "void place_vertex()"}}),
                   declarations, "void main() {\nplace_vertex();\n", assignments, "}\n");
  return flat;
}

}  // namespace thunderhead::gl
