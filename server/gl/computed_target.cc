#include "gl/computed_target.h"

#include <optional>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"

namespace thunderhead::gl {
namespace {

struct Output {
  int location = 0;
  std::string type;
  std::string name;
};

std::optional<Output> OutputIn(absl::string_view row) {
  Output output;
  if (absl::ConsumePrefix(&row, "layout(location = ")) {
    const std::size_t end = row.find(')');
    if (end == absl::string_view::npos || !absl::SimpleAtoi(row.substr(0, end), &output.location)) {
      return std::nullopt;
    }
    row.remove_prefix(end + 1);
    absl::ConsumePrefix(&row, " ");
  }
  if (!absl::ConsumePrefix(&row, "out ")) return std::nullopt;
  const std::vector<std::string> words = absl::StrSplit(row.substr(0, row.find(';')), ' ');
  if (words.size() != 2) return std::nullopt;
  output.type = words[0];
  output.name = words[1];
  return output;
}

}  // namespace

std::string AsComputedPixel(const std::string& fragment) {
  std::string pixel = "vec2 position;\nvec4 pixel_centre;\n";
  std::string images;
  std::string stores;
  for (const absl::string_view row : absl::StrSplit(fragment, '\n')) {
    if (absl::StartsWith(row, "in vec2 position;")) {
      absl::StrAppend(&pixel, "\n");
      continue;
    }
    const std::optional<Output> output = OutputIn(row);
    if (!output.has_value()) {
      absl::StrAppend(&pixel, row, "\n");
      continue;
    }
    absl::StrAppend(&pixel, output->type, " ", output->name, ";\n");
    absl::StrAppend(&images, "layout(binding = kTargetImages + ", output->location,
                    ") writeonly uniform image2D image_of_", output->name, ";\n");
    absl::StrAppend(&stores, "  imageStore(image_of_", output->name, ", pixel, ",
                    output->type == "float"
                        ? absl::StrCat("vec4(", output->name, ", 0.0, 0.0, 0.0)")
                        : output->name,
                    ");\n");
  }
  return absl::StrCat(absl::StrReplaceAll(pixel, {{"void main()", "void draw_pixel()"},
                                                  {"gl_FragCoord", "pixel_centre"}}),
                      images, "void store_pixel(ivec2 pixel) {\n", stores, "}\n");
}

}  // namespace thunderhead::gl
