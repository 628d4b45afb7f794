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

namespace thunderhead::measure {
namespace {

constexpr char kColumns[] =
    "renderer,mode,transport,slices,image_scale,jpeg_quality,milliseconds,milliseconds_spread,"
    "bytes,relative_rmse,relative_bias,flip";
constexpr std::size_t kColumnCount = 12;

template <typename Value>
bool Named(absl::string_view name, std::initializer_list<Value> values, Value* found) {
  for (const Value value : values) {
    if (name != NameOf(value)) continue;
    *found = value;
    return true;
  }
  return false;
}

std::optional<TradeRow> RowOf(absl::string_view line) {
  const std::vector<absl::string_view> cells = absl::StrSplit(line, ',');
  if (cells.size() != kColumnCount) return std::nullopt;
  TradeRow row;
  TradeSetting& setting = row.setting;
  std::uint64_t bytes = 0;
  const bool read =
      Named(cells[0], {scene::Renderer::kHalfAngle, scene::Renderer::kLightVolume},
            &setting.renderer) &&
      Named(cells[1],
            {scene::Mode::kUniformPhaseLowAlbedo, scene::Mode::kUniformPhaseTranslucent,
             scene::Mode::kPerFieldPhaseTranslucent},
            &setting.mode) &&
      Named(cells[2], {scene::Transport::kPaper, scene::Transport::kConsistent},
            &setting.transport) &&
      absl::SimpleAtoi(cells[3], &setting.slices) &&
      absl::SimpleAtod(cells[4], &setting.image_scale) &&
      absl::SimpleAtoi(cells[5], &setting.jpeg_quality) &&
      absl::SimpleAtod(cells[6], &row.milliseconds) &&
      absl::SimpleAtod(cells[7], &row.milliseconds_spread) && absl::SimpleAtoi(cells[8], &bytes) &&
      absl::SimpleAtod(cells[9], &row.relative_rmse) &&
      absl::SimpleAtod(cells[10], &row.relative_bias) && absl::SimpleAtod(cells[11], &row.flip);
  row.bytes = bytes;
  if (!read) return std::nullopt;
  return row;
}

std::string Quoted(const std::string& text) {
  return absl::StrCat("\"", absl::StrReplaceAll(text, {{"\\", "\\\\"}, {"\"", "\\\""}}), "\"");
}

// A logarithmic axis over the values.
struct Axis {
  double low, high, from_px, to_px;

  Axis(std::vector<double> values, double from, double to) : from_px(from), to_px(to) {
    const auto [least, most] = std::minmax_element(values.begin(), values.end());
    low = std::log10(*least) - 0.05;
    high = std::log10(*most) + 0.05;
  }
  double At(double value) const {
    return from_px + (std::log10(value) - low) / (high - low) * (to_px - from_px);
  }
  // 1, 2 and 5 times powers of ten within the axis.
  std::vector<double> Ticks() const {
    std::vector<double> ticks;
    for (int power = static_cast<int>(std::floor(low)); power <= std::ceil(high); ++power) {
      for (const double digit : {1.0, 2.0, 5.0}) {
        const double tick = digit * std::pow(10.0, power);
        if (std::log10(tick) >= low && std::log10(tick) <= high) ticks.push_back(tick);
      }
    }
    return ticks;
  }
};

// Blue marches, orange slices; hollow for paper transport.
std::string Marker(const TradeRow& row, double x, double y) {
  const char* color = row.setting.renderer == scene::Renderer::kLightVolume ? "#1f6fb4" : "#d9730d";
  const bool hollow = row.setting.transport == scene::Transport::kPaper;
  return absl::StrFormat(
      "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"%d\" fill=\"%s\" stroke=\"%s\"><title>%s, %s, %s, %d "
      "slices, scale %g, JPEG %d: %.2f ms, RMSE %.3f, FLIP %.3f</title></circle>\n",
      x, y, row.pareto ? 5 : 3, hollow ? "#ffffff" : color, color, NameOf(row.setting.renderer),
      NameOf(row.setting.mode), NameOf(row.setting.transport), row.setting.slices,
      row.setting.image_scale, row.setting.jpeg_quality, row.milliseconds, row.relative_rmse,
      row.flip);
}

std::string Front(const std::vector<TradeRow>& rows, const Axis& across, const Axis& up) {
  std::vector<TradeRow> front;
  for (const TradeRow& row : rows) {
    if (row.pareto) front.push_back(row);
  }
  std::sort(front.begin(), front.end(),
            [](const TradeRow& a, const TradeRow& b) { return a.milliseconds < b.milliseconds; });
  const std::string points = absl::StrJoin(front, " ", [&](std::string* text, const TradeRow& row) {
    absl::StrAppendFormat(text, "%.1f,%.1f", across.At(row.milliseconds), up.At(row.relative_rmse));
  });
  return absl::StrCat("<polyline fill=\"none\" stroke=\"#555555\" points=\"", points, "\"/>\n");
}

}  // namespace

std::string CsvHead(const TradeTitle& title) {
  return absl::StrFormat(
      "# storm: %s\n# view: %s\n# renderer: %s\n# size: %dx%d\n# truth: %d samples a pixel, "
      "relative "
      "noise %.4f\n%s\n",
      title.storm, title.view, title.renderer, title.size_px.x, title.size_px.y,
      title.truth_samples_per_pixel, title.truth_noise, kColumns);
}

std::string CsvLine(const TradeRow& row) {
  const TradeSetting& setting = row.setting;
  return absl::StrFormat("%s,%s,%s,%d,%g,%d,%.3f,%.3f,%d,%.5f,%.5f,%.5f\n",
                         NameOf(setting.renderer), NameOf(setting.mode), NameOf(setting.transport),
                         setting.slices, setting.image_scale, setting.jpeg_quality,
                         row.milliseconds, row.milliseconds_spread, row.bytes, row.relative_rmse,
                         row.relative_bias, row.flip);
}

absl::StatusOr<std::vector<TradeRow>> ReadCsv(std::string_view text, std::string_view head) {
  absl::string_view rest(text.data(), text.size());
  if (!absl::ConsumePrefix(&rest, absl::string_view(head.data(), head.size()))) {
    return absl::InvalidArgumentError(
        "it was measured on another storm, view, machine or size; name another file or remove it");
  }
  std::vector<TradeRow> rows;
  const std::vector<absl::string_view> lines = absl::StrSplit(rest, '\n');
  // What follows the last line's end is empty, or half a line.
  for (std::size_t i = 0; i + 1 < lines.size(); ++i) {
    const std::optional<TradeRow> row = RowOf(lines[i]);
    if (!row.has_value()) {
      return absl::InvalidArgumentError(absl::StrCat("'", lines[i], "' is not a row of it"));
    }
    rows.push_back(*row);
  }
  return rows;
}

std::string TradeJson(const TradeTitle& title, const std::vector<TradeRow>& rows) {
  std::string text = absl::StrFormat(
      "{\n  \"machine\": {\"renderer\": %s},\n  \"storm\": %s,\n  \"view\": %s,\n  \"width_px\": "
      "%d,\n  \"height_px\": %d,\n  \"truth\": {\"samples_per_pixel\": %d, \"relative_noise\": "
      "%.6g},\n  \"rows\": [\n",
      Quoted(title.renderer), Quoted(title.storm), Quoted(title.view), title.size_px.x,
      title.size_px.y, title.truth_samples_per_pixel, title.truth_noise);
  absl::StrAppend(&text, absl::StrJoin(rows, ",\n", [](std::string* out, const TradeRow& row) {
    const TradeSetting& setting = row.setting;
    absl::StrAppendFormat(
        out,
        "    {\"renderer\": \"%s\", \"mode\": \"%s\", \"transport\": \"%s\", \"slices\": %d, "
        "\"image_scale\": %g, \"jpeg_quality\": %d, \"milliseconds\": %.3f, "
        "\"milliseconds_spread\": %.3f, \"bytes\": %d, \"relative_rmse\": %.5f, "
        "\"relative_bias\": %.5f, \"flip\": %.5f, \"pareto\": %s}",
        NameOf(setting.renderer), NameOf(setting.mode), NameOf(setting.transport), setting.slices,
        setting.image_scale, setting.jpeg_quality, row.milliseconds, row.milliseconds_spread,
        row.bytes, row.relative_rmse, row.relative_bias, row.flip, row.pareto ? "true" : "false");
  }));
  return absl::StrCat(text, "\n  ]\n}\n");
}

std::string TradeSvg(const TradeTitle& title, const std::vector<TradeRow>& rows) {
  std::string svg =
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 720 440\" "
      "font-family=\"sans-serif\" "
      "font-size=\"12\">\n<rect width=\"720\" height=\"440\" fill=\"#ffffff\"/>\n";
  if (rows.empty()) return absl::StrCat(svg, "</svg>\n");
  std::vector<double> times;
  std::vector<double> errors;
  for (const TradeRow& row : rows) {
    times.push_back(std::max(row.milliseconds, 1e-3));
    errors.push_back(std::max(row.relative_rmse, 1e-6));
  }
  const Axis across(times, 60.0, 700.0);
  const Axis up(errors, 390.0, 40.0);
  for (const double tick : across.Ticks()) {
    absl::StrAppendFormat(&svg,
                          "<path d=\"M%.1f 40V390\" stroke=\"#dddddd\"/><text x=\"%.1f\" y=\"405\" "
                          "text-anchor=\"middle\">%g</text>\n",
                          across.At(tick), across.At(tick), tick);
  }
  for (const double tick : up.Ticks()) {
    absl::StrAppendFormat(&svg,
                          "<path d=\"M60 %.1fH700\" stroke=\"#dddddd\"/><text x=\"54\" y=\"%.1f\" "
                          "text-anchor=\"end\">%g</text>\n",
                          up.At(tick), up.At(tick) + 4.0, tick);
  }
  absl::StrAppendFormat(
      &svg,
      "<text x=\"60\" y=\"24\">%s, %s: relative RMSE against milliseconds a frame "
      "(%dx%d)</text>\n<text x=\"60\" y=\"428\">blue: light volume, orange: "
      "half-angle slices; hollow: paper transport; line: Pareto front</text>\n",
      title.storm, title.view, title.size_px.x, title.size_px.y);
  absl::StrAppend(&svg, Front(rows, across, up));
  for (const TradeRow& row : rows) {
    absl::StrAppend(&svg, Marker(row, across.At(std::max(row.milliseconds, 1e-3)),
                                 up.At(std::max(row.relative_rmse, 1e-6))));
  }
  return absl::StrCat(svg, "</svg>\n");
}

}  // namespace thunderhead::measure
