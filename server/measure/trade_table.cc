#include "measure/trade_table.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "accuracy/named_settings.h"
#include "measure/log_plot.h"

namespace thunderhead::measure {
namespace {

constexpr char kColumns[] =
    "renderer,mode,transport,slices,image_scale,light_detail,precision,million_paths,jpeg_quality,"
    "milliseconds,"
    "milliseconds_spread,bytes,relative_rmse,relative_bias,flip,estimated_error,error_low,error_"
    "high";
constexpr std::size_t kColumnCount = 18;

constexpr char kHalf[] = "half";
constexpr char kSingle[] = "single";

const char* PrecisionOf(const Setting& setting) {
  return setting.single_precision ? kSingle : kHalf;
}

// Values drawn in place of smaller values, because both axes are logarithmic.
constexpr double kMinMilliseconds = 1e-3;
constexpr double kMinTradeError = 1e-6;

std::optional<TradeRow> RowOf(absl::string_view line) {
  const std::vector<absl::string_view> cells = absl::StrSplit(line, ',');
  if (cells.size() != kColumnCount) return std::nullopt;
  TradeRow row;
  Setting& setting = row.setting;
  std::uint64_t bytes = 0;
  const auto technique =
      accuracy::TechniqueNamed(std::string(cells[0]), std::string(cells[1]), std::string(cells[2]));
  int count = 0;
  if (!technique.has_value() || !absl::SimpleAtoi(cells[3], &count)) return std::nullopt;
  setting.technique = *technique;
  scene::SetCount(&setting.technique, count);
  const bool read =
      absl::SimpleAtod(cells[4], &setting.image_scale) &&
      absl::SimpleAtod(cells[5], &setting.light_detail) &&
      (cells[6] == kHalf || cells[6] == kSingle) &&
      absl::SimpleAtod(cells[7], &setting.million_paths) &&
      absl::SimpleAtoi(cells[8], &setting.jpeg_quality) &&
      absl::SimpleAtod(cells[9], &row.milliseconds) &&
      absl::SimpleAtod(cells[10], &row.milliseconds_spread) &&
      absl::SimpleAtoi(cells[11], &bytes) && absl::SimpleAtod(cells[12], &row.relative_rmse) &&
      absl::SimpleAtod(cells[13], &row.relative_bias) && absl::SimpleAtod(cells[14], &row.flip) &&
      absl::SimpleAtod(cells[15], &row.estimated_error.value) &&
      absl::SimpleAtod(cells[16], &row.estimated_error.low) &&
      absl::SimpleAtod(cells[17], &row.estimated_error.high);
  setting.single_precision = cells[6] == kSingle;
  row.bytes = bytes;
  if (!read) return std::nullopt;
  return row;
}

std::string Quoted(const std::string& text) {
  return absl::StrCat("\"", absl::StrReplaceAll(text, {{"\\", "\\\\"}, {"\"", "\\\""}}), "\"");
}

const char* ColorOf(const scene::Technique& technique) {
  const std::string_view name = scene::NameOf(technique);
  if (name == scene::LightVolume::kName) return "#1f6fb4";
  if (name == scene::HalfAngle::kName) return "#d9730d";
  if (name == scene::Metaballs::kName) return "#3f9142";
  if (name == scene::Cumulus::kName) return "#8a4fbf";
  return "#000000";
}

// Colours: blue is the light volume, orange half-angle slicing, green metaballs and violet
// surfaces. Hollow dots are the paper's transport.
void AddDot(const TradeRow& row, LogPlot* plot) {
  const scene::Technique& technique = row.setting.technique;
  const char* color = ColorOf(technique);
  const bool hollow = accuracy::TransportNameOf(technique) == "paper";
  const std::string tip = absl::StrFormat(
      "%s, %s, %s, %d %s, scale %g, light detail %g, %s precision, %g million paths, JPEG %d: %.2f "
      "ms, RMSE %.3f, FLIP %.3f",
      scene::NameOf(technique), accuracy::ModeOf(technique).name,
      accuracy::TransportNameOf(technique), scene::CountOf(technique),
      std::holds_alternative<scene::Metaballs>(technique) ? "balls" : "slices",
      row.setting.image_scale, row.setting.light_detail, PrecisionOf(row.setting),
      row.setting.million_paths, row.setting.jpeg_quality, row.milliseconds, row.relative_rmse,
      row.flip);
  plot->Dot(std::max(row.milliseconds, kMinMilliseconds),
            std::max(row.relative_rmse, kMinTradeError), row.pareto ? 5 : 3,
            hollow ? "#ffffff" : color, color, tip);
}

std::vector<std::pair<double, double>> FrontOf(const std::vector<TradeRow>& rows) {
  std::vector<std::pair<double, double>> front;
  for (const TradeRow& row : rows) {
    if (!row.pareto) continue;
    front.emplace_back(std::max(row.milliseconds, kMinMilliseconds),
                       std::max(row.relative_rmse, kMinTradeError));
  }
  std::sort(front.begin(), front.end());
  return front;
}

// JSON has no NaN, so the values of an estimate that was not made are left out.
std::string EstimateJson(const TradeRow& row) {
  const accuracy::Estimated& error = row.estimated_error;
  if (std::isnan(error.value)) return "\"measured\": false, ";
  return absl::StrFormat(
      "\"estimated_error\": %.5f, \"error_low\": %.5f, \"error_high\": %.5f, \"measured\": true, ",
      error.value, error.low, error.high);
}

}  // namespace

std::string CsvHead(const TradeTitle& title) {
  return absl::StrFormat(
      "# storm: %s\n# view: %s\n# renderer: %s\n# size: %dx%d\n# reference: %d samples a pixel, "
      "relative noise %.4f\n%s\n",
      title.storm, title.view, title.renderer, title.size_px.x, title.size_px.y,
      title.reference_samples_per_pixel, title.reference_noise, kColumns);
}

std::string CsvLine(const TradeRow& row) {
  const Setting& setting = row.setting;
  return absl::StrFormat("%s,%s,%s,%d,%g,%g,%s,%g,%d,%.3f,%.3f,%d,%.5f,%.5f,%.5f,%.5f,%.5f,%.5f\n",
                         scene::NameOf(setting.technique), accuracy::ModeOf(setting.technique).name,
                         accuracy::TransportNameOf(setting.technique),
                         scene::CountOf(setting.technique), setting.image_scale,
                         setting.light_detail, PrecisionOf(setting), setting.million_paths,
                         setting.jpeg_quality, row.milliseconds, row.milliseconds_spread, row.bytes,
                         row.relative_rmse, row.relative_bias, row.flip, row.estimated_error.value,
                         row.estimated_error.low, row.estimated_error.high);
}

absl::StatusOr<std::vector<TradeRow>> ReadCsv(std::string_view text, std::string_view head) {
  absl::string_view rest(text.data(), text.size());
  if (!absl::ConsumePrefix(&rest, absl::string_view(head.data(), head.size()))) {
    return absl::InvalidArgumentError(
        "it was measured on another storm, view, machine or size; name another file or remove it");
  }
  std::vector<TradeRow> rows;
  const std::vector<absl::string_view> lines = absl::StrSplit(rest, '\n');
  // After the last line break, the text is empty or an incomplete line.
  for (std::size_t i = 0; i + 1 < lines.size(); ++i) {
    const std::optional<TradeRow> row = RowOf(lines[i]);
    if (!row.has_value()) {
      return absl::InvalidArgumentError(
          absl::StrCat("'", lines[i], "' is not a row of this table"));
    }
    rows.push_back(*row);
  }
  return rows;
}

std::string TradeJson(const TradeTitle& title, const std::vector<TradeRow>& rows) {
  std::string text = absl::StrFormat(
      "{\n  \"machine\": {\"renderer\": %s},\n  \"storm\": %s,\n  \"view\": %s,\n  \"width_px\": "
      "%d,\n  \"height_px\": %d,\n  \"reference\": {\"samples_per_pixel\": %d, \"relative_noise\": "
      "%.6g},\n  \"rows\": [\n",
      Quoted(title.renderer), Quoted(title.storm), Quoted(title.view), title.size_px.x,
      title.size_px.y, title.reference_samples_per_pixel, title.reference_noise);
  absl::StrAppend(&text, absl::StrJoin(rows, ",\n", [](std::string* out, const TradeRow& row) {
    const Setting& setting = row.setting;
    absl::StrAppendFormat(
        out,
        "    {\"renderer\": \"%s\", \"mode\": \"%s\", \"transport\": \"%s\", \"slices\": %d, "
        "\"image_scale\": %g, \"light_detail\": %g, \"precision\": \"%s\", "
        "\"million_paths\": %g, \"jpeg_quality\": %d, \"milliseconds\": %.3f, "
        "\"milliseconds_spread\": %.3f, \"bytes\": %d, \"relative_rmse\": %.5f, "
        "\"relative_bias\": %.5f, \"flip\": %.5f, %s\"pareto\": %s}",
        scene::NameOf(setting.technique), accuracy::ModeOf(setting.technique).name,
        accuracy::TransportNameOf(setting.technique), scene::CountOf(setting.technique),
        setting.image_scale, setting.light_detail, PrecisionOf(setting), setting.million_paths,
        setting.jpeg_quality, row.milliseconds, row.milliseconds_spread, row.bytes,
        row.relative_rmse, row.relative_bias, row.flip, EstimateJson(row),
        row.pareto ? "true" : "false");
  }));
  return absl::StrCat(text, "\n  ]\n}\n");
}

std::string TradeSvg(const TradeTitle& title, const std::vector<TradeRow>& rows) {
  if (rows.empty()) return "<svg xmlns=\"http://www.w3.org/2000/svg\"></svg>\n";
  std::vector<double> times;
  std::vector<double> errors;
  for (const TradeRow& row : rows) {
    times.push_back(std::max(row.milliseconds, kMinMilliseconds));
    errors.push_back(std::max(row.relative_rmse, kMinTradeError));
  }
  LogPlot plot(times, errors,
               absl::StrFormat("%s, %s: relative RMSE against milliseconds a frame (%dx%d)",
                               title.storm, title.view, title.size_px.x, title.size_px.y),
               "blue: light volume, orange: half-angle slices, green: metaballs, violet: cumulus "
               "surfaces; hollow: paper "
               "transport; line: "
               "Pareto front");
  plot.Line(FrontOf(rows), "#555555");
  for (const TradeRow& row : rows) AddDot(row, &plot);
  return plot.Svg();
}

}  // namespace thunderhead::measure
