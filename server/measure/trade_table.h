// Rows of the trade as text: CSV from which a later run continues, JSON, and an SVG plot. Pure
// functions.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "measure/trade.h"

namespace thunderhead::measure {

// The subject of the rows.
struct TradeTitle {
  std::string storm;
  std::string view;      // a name for people
  std::string renderer;  // OpenGL's renderer string
  glm::ivec2 size_px{0};
  int truth_samples_per_pixel = 0;
  double truth_noise = 0.0;  // relative RMSE
};

// The first lines of a CSV file: comments with the title, then the names of the columns.
std::string CsvHead(const TradeTitle& title);
std::string CsvLine(const TradeRow& row);

// The rows of a file that begins with `head`. INVALID_ARGUMENT if it does not, or names the line
// that cannot be parsed. A last line without its end, from an interrupted run, is ignored.
absl::StatusOr<std::vector<TradeRow>> ReadCsv(std::string_view text, std::string_view head);

std::string TradeJson(const TradeTitle& title, const std::vector<TradeRow>& rows);

// Milliseconds across, relative RMSE up, both logarithmic; the Pareto front joined by a line.
std::string TradeSvg(const TradeTitle& title, const std::vector<TradeRow>& rows);

}  // namespace thunderhead::measure
