#include "physics/tables/curves_svg.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace thunderhead::physics {
namespace {

constexpr double kWidth = 360;
constexpr double kHeight = 220;
constexpr double kLeft = 46;
constexpr double kTop = 24;
constexpr double kGap = 70;
constexpr double kLowest = -2;  // exponents of 10 at the ends of the axis
constexpr double kHighest = 4;
constexpr std::size_t kColumns = 2;

double X(double angle_deg) { return kLeft + angle_deg / 180.0 * kWidth; }

double Y(double value) {
  const double decades = std::clamp(std::log10(std::max(value, 1e-9)), kLowest, kHighest);
  return kTop + (kHighest - decades) / (kHighest - kLowest) * kHeight;
}

void AppendFrame(const std::string& name, std::string& svg) {
  absl::StrAppendFormat(&svg, "<text x='%g' y='%g' font-weight='bold'>%s</text>\n", kLeft, kTop - 8,
                        name);
  for (int angle = 0; angle <= 180; angle += 20) {
    absl::StrAppendFormat(&svg, "<path d='M%.1f %gv%g' stroke='#ddd'/>", X(angle), kTop, kHeight);
    absl::StrAppendFormat(&svg, "<text x='%.1f' y='%g' text-anchor='middle'>%d</text>\n", X(angle),
                          kTop + kHeight + 14, angle);
  }
  for (int decade = static_cast<int>(kLowest); decade <= kHighest; ++decade) {
    const double y = Y(std::pow(10.0, decade));
    absl::StrAppendFormat(&svg, "<path d='M%g %.1fh%g' stroke='#ddd'/>", kLeft, y, kWidth);
    absl::StrAppendFormat(&svg, "<text x='%g' y='%.1f' text-anchor='end'>1e%d</text>\n", kLeft - 4,
                          y + 4, decade);
  }
}

void AppendCurve(const PhaseTable& table, std::size_t channel, std::string& svg) {
  constexpr std::array<const char*, kPhaseChannels> kColors = {"#d22", "#191", "#22d"};
  absl::StrAppendFormat(&svg, "<path fill='none' stroke='%s' stroke-width='0.8' d='",
                        kColors[channel]);
  for (std::size_t i = 0; i < table.angles_deg().size(); ++i) {
    absl::StrAppendFormat(&svg, "%c%.1f %.1f", i == 0 ? 'M' : 'L', X(table.angles_deg()[i]),
                          Y(table.values()[i][channel]));
  }
  absl::StrAppend(&svg, "'/>\n");
}

}  // namespace

std::string CurvesSvg(const std::vector<PhaseTable>& tables) {
  const double width = kLeft + static_cast<double>(kColumns) * (kWidth + kGap);
  const std::size_t rows = (tables.size() + kColumns - 1) / kColumns;
  const double height = static_cast<double>(rows) * (kHeight + kGap);
  std::string svg = absl::StrFormat(
      "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 %g %g' font-family='sans-serif' "
      "font-size='10'>\n<rect width='100%%' height='100%%' fill='#fff'/>\n",
      width, height);
  for (std::size_t i = 0; i < tables.size(); ++i) {
    const std::size_t column = i % kColumns;
    const std::size_t row = i / kColumns;
    absl::StrAppendFormat(&svg, "<g transform='translate(%g %g)'>\n",
                          static_cast<double>(column) * (kWidth + kGap),
                          static_cast<double>(row) * (kHeight + kGap));
    AppendFrame(tables[i].name(), svg);
    for (std::size_t channel = 0; channel < kPhaseChannels; ++channel) {
      AppendCurve(tables[i], channel, svg);
    }
    absl::StrAppend(&svg, "</g>\n");
  }
  return absl::StrCat(svg, "</svg>\n");
}

}  // namespace thunderhead::physics
