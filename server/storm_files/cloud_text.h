// Cloud fields of radiative transfer programs as storms. The programs write texts that begin with a
// header (the grid) and continue with one line for each grid point that has particles. A dialect
// reads the header, and says what the columns of the lines mean. The rest is the same for all.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "base/byte_source.h"
#include "glm/vec3.hpp"
#include "storm_files/number_text.h"
#include "storm_files/storm_file.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::storm_files {

// Maximum number of terms of a phase function. The series of SHDOM have some thousand terms.
inline constexpr int kMostSeriesTerms = 20'000;

// The columns of a line: the indices of a grid point, then values.
struct CloudColumns {
  bool has_y = true;   // false if the lines have no index along y, because there is one row
  int values = 1;      // number of values after the indices
  int amount_at = 0;   // index of the amount among the values
  int radius_at = -1;  // index of the effective radius among the values; -1 if there is none
  // True if, instead of values, there is the number of components, and then for each its type, its
  // mass and its effective radius.
  bool has_components = false;
  // True if the values are followed by the length of a series and its terms, perhaps on more lines.
  bool has_series = false;
};

// The header of a cloud text.
struct CloudHeader {
  std::string about;  // description for users
  glm::ivec3 cells{0};
  double dx_m = 0.0;
  double dy_m = 0.0;
  std::vector<double> heights_m;      // of the grid points, or of the faces between layers
  bool heights_are_faces = false;     // if true, there is one height more than layers
  std::vector<double> temperature_K;  // at the heights; empty if the file has none
  // In g m-3 if it is a mass concentration, and in km-1 if it is an extinction. Radii are in um.
  volume::Quantity quantity = volume::Quantity::kMassConcentration;
  std::string variable;  // name of the amount
  CloudColumns columns;
  int first_index = 1;  // index of the first grid point along each axis, as the program counts
  std::vector<std::string> assumptions;
};

struct CloudDialect {
  std::string_view program;   // for messages
  std::string_view comments;  // characters that begin a comment
  // Reads the header. The next line of `text` is then that of the first grid point.
  absl::StatusOr<CloudHeader> (*read_header)(NumberText& text);
};

// Reads the grid's size, in number of grid points along x, y and z, from the current line.
absl::Status ReadCloudSize(NumberText& text, CloudHeader& header);

// Reads the distances between columns in km.
absl::Status ReadCloudSpacing(NumberText& text, CloudHeader& header);

// Reads as many heights in km as there are layers. Numbers may continue on further lines. If
// `may_have_faces` is true and one more number follows on the line, the heights are those of faces.
absl::Status ReadCloudHeights(NumberText& text, bool may_have_faces, CloudHeader& header);

// Reads and checks the whole text, and sets the reader. Errors name the line.
absl::StatusOr<StormFile> DescribeCloudText(std::shared_ptr<const base::ByteSource> bytes,
                                            const CloudDialect& dialect);

}  // namespace thunderhead::storm_files
