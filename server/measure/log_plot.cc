#include "measure/log_plot.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"

namespace thunderhead::measure {

LogPlot::Axis::Axis(const std::vector<double>& values, double from, double to)
    : from_px(from), to_px(to) {
  const auto [min, max] = std::minmax_element(values.begin(), values.end());
  low = std::log10(*min) - 0.1;
  high = std::log10(*max) + 0.1;
}

double LogPlot::Axis::At(double value) const {
  return from_px + (std::log10(value) - low) / (high - low) * (to_px - from_px);
}

// Returns 1, 2 and 5 times powers of ten. If the axis spans more than three decades, it returns
// only the powers.
std::vector<double> LogPlot::Axis::Ticks() const {
  std::vector<double> ticks;
  for (int power = static_cast<int>(std::floor(low)); power <= std::ceil(high); ++power) {
    for (const double digit : {1.0, 2.0, 5.0}) {
      if (digit > 1.0 && high - low > 3.0) continue;
      const double tick = digit * std::pow(10.0, power);
      if (std::log10(tick) >= low && std::log10(tick) <= high) ticks.push_back(tick);
    }
  }
  return ticks;
}

LogPlot::LogPlot(const std::vector<double>& x, const std::vector<double>& y,
                 const std::string& title, const std::string& note)
    : across_(x, 60.0, 700.0),
      up_(y, 390.0, 40.0),
      svg_(
          "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 720 440\" "
          "font-family=\"sans-serif\" font-size=\"12\">\n"
          "<rect width=\"720\" height=\"440\" fill=\"#ffffff\"/>\n") {
  for (const double tick : across_.Ticks()) {
    absl::StrAppendFormat(&svg_,
                          "<path d=\"M%.1f 40V390\" stroke=\"#dddddd\"/><text x=\"%.1f\" y=\"405\" "
                          "text-anchor=\"middle\">%g</text>\n",
                          across_.At(tick), across_.At(tick), tick);
  }
  for (const double tick : up_.Ticks()) {
    absl::StrAppendFormat(&svg_,
                          "<path d=\"M60 %.1fH700\" stroke=\"#dddddd\"/><text x=\"54\" y=\"%.1f\" "
                          "text-anchor=\"end\">%g</text>\n",
                          up_.At(tick), up_.At(tick) + 4.0, tick);
  }
  absl::StrAppend(&svg_, "<text x=\"60\" y=\"24\">", title, "</text>\n<text x=\"60\" y=\"428\">",
                  note, "</text>\n");
}

void LogPlot::Line(const std::vector<std::pair<double, double>>& points, const std::string& color) {
  const std::string text =
      absl::StrJoin(points, " ", [&](std::string* out, const std::pair<double, double>& point) {
        absl::StrAppendFormat(out, "%.1f,%.1f", across_.At(point.first), up_.At(point.second));
      });
  absl::StrAppend(&svg_, "<polyline fill=\"none\" stroke=\"", color, "\" points=\"", text,
                  "\"/>\n");
}

void LogPlot::Dot(double x, double y, int radius, const std::string& fill,
                  const std::string& stroke, const std::string& tip) {
  absl::StrAppendFormat(
      &svg_,
      "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"%d\" fill=\"%s\" stroke=\"%s\"><title>%s"
      "</title></circle>\n",
      across_.At(x), up_.At(y), radius, fill, stroke, tip);
}

std::string LogPlot::Svg() const { return svg_ + "</svg>\n"; }

}  // namespace thunderhead::measure
