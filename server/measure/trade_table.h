// Rows of the trade measurement (trade.h) as text: CSV from which a later run continues, JSON, and
// an SVG plot. The functions are pure.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "measure/trade.h"

namespace thunderhead::measure {

// The conditions of the measurement.
struct TradeTitle {
  std::string storm;
  std::string view;      // display name of the view
  std::string renderer;  // OpenGL's renderer string (GL_RENDERER)
  glm::ivec2 size_px{0};
  int reference_samples_per_pixel = 0;
  double reference_noise = 0.0;  // relative RMSE of the reference's own noise
};

// Returns the first lines of a CSV file: comments with the title, then the names of the columns.
std::string CsvHead(const TradeTitle& title);
std::string CsvLine(const TradeRow& row);

// Returns the rows of a file that begins with `head`. Returns INVALID_ARGUMENT if the file begins
// differently, or if a line cannot be parsed. The error message quotes the line. An incomplete last
// line, from an interrupted run, is ignored.
absl::StatusOr<std::vector<TradeRow>> ReadCsv(std::string_view text, std::string_view head);

std::string TradeJson(const TradeTitle& title, const std::vector<TradeRow>& rows);

// Returns a plot of relative RMSE over milliseconds with logarithmic axes. A line connects the
// settings on the Pareto front.
std::string TradeSvg(const TradeTitle& title, const std::vector<TradeRow>& rows);

}  // namespace thunderhead::measure
