// An SVG plot with two logarithmic axes that fit the data. The class works on numbers and text
// only.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace thunderhead::measure {

class LogPlot {
 public:
  // Creates axes that contain all values of `x` and `y`. Neither may be empty, and all values must
  // be above 0. `title` is above the plot, `note` below.
  LogPlot(const std::vector<double>& x, const std::vector<double>& y, const std::string& title,
          const std::string& note);

  // Draws a line that connects the points in their order.
  void Line(const std::vector<std::pair<double, double>>& points, const std::string& color);
  // Adds a dot of `radius` pixels with the tool tip `tip`.
  void Dot(double x, double y, int radius, const std::string& fill, const std::string& stroke,
           const std::string& tip);

  std::string Svg() const;

 private:
  struct Axis {
    Axis(const std::vector<double>& values, double from, double to);
    double At(double value) const;
    std::vector<double> Ticks() const;

    double low = 0.0;
    double high = 1.0;
    double from_px = 0.0;
    double to_px = 1.0;
  };

  Axis across_;
  Axis up_;
  std::string svg_;
};

}  // namespace thunderhead::measure
