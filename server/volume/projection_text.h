// A map projection as text in PROJ's notation, such as "+proj=lcc +lat_1=30 +R=6370000". Storm
// files are untrusted, and PROJ's notation can name files and whole pipelines. This code therefore
// accepts only the projections and parameters in a list, none of which opens a file.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"

namespace thunderhead::volume {

class ProjectionText {
 public:
  // Parses and checks `text`. It must name a projection whose coordinates are metres, and a figure
  // of the Earth. Otherwise it returns INVALID_ARGUMENT with the first parameter that is not
  // accepted.
  static absl::StatusOr<ProjectionText> Parse(std::string_view text);

  // Returns the projection's name in PROJ's notation: the value of "proj", or of "o_proj" for a
  // projection with a rotated pole.
  const std::string& Kind() const { return kind_; }
  bool HasRotatedPole() const { return Has("o_proj"); }

  bool Has(std::string_view parameter) const;
  // Returns a parameter's text, or "" if it is missing.
  std::string Text(std::string_view parameter) const;
  // Returns a parameter's value, or nothing if it is missing or not a number.
  std::optional<double> Number(std::string_view parameter) const;

 private:
  ProjectionText() = default;

  std::map<std::string, std::string, std::less<>> parameters_;
  std::string kind_;
};

}  // namespace thunderhead::volume
