#include "measure/slice_convergence.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "base/status.h"
#include "frame/tone_map.h"
#include "measure/image_error.h"
#include "measure/log_plot.h"
#include "renderers/scene_renderer.h"

namespace thunderhead::measure {
namespace {

constexpr std::array kCounts = {8, 16, 32, 64, 128, 256};
constexpr int kLimit = 2048;  // number of slices whose picture stands for the converged picture

// Relative rounding error of half floats.
constexpr double kFrameRounding = 0x1p-12;

// Error drawn in place of smaller errors, because the axis is logarithmic.
constexpr double kMinSliceError = 1e-9;

absl::StatusOr<picture::LinearPicture> DrawWith(
    renderers::SceneRenderer& renderer, scene::Scene scene, int slices,
    const std::shared_ptr<const volume::HydrometeorFields>& fields) {
  scene::SetSlices(&scene.rendering.technique, slices);
  THUNDERHEAD_ASSIGN_OR_RETURN(const renderers::LinearFrame frame,
                               renderer.Draw(scene, fields, {}));
  return frame::PictureOf(*frame.radiance);
}

}  // namespace

double OrderOf(const std::vector<SlicePoint>& all) {
  std::vector<SlicePoint> points;
  for (const SlicePoint& point : all) {
    if (point.relative_rmse > 10.0 * kFrameRounding) points.push_back(point);
  }
  if (points.size() < 2) points = all;
  double x_mean = 0.0;
  double y_mean = 0.0;
  const auto count = static_cast<double>(points.size());
  const auto y_of = [](const SlicePoint& point) {
    return std::log(std::max(point.relative_rmse, kMinSliceError));
  };
  for (const SlicePoint& point : points) {
    x_mean += std::log(point.slices) / count;
    y_mean += y_of(point) / count;
  }
  double covariance = 0.0;
  double variance = 0.0;
  for (const SlicePoint& point : points) {
    const double x = std::log(point.slices) - x_mean;
    covariance += x * (y_of(point) - y_mean);
    variance += x * x;
  }
  return variance > 0.0 ? -covariance / variance : 0.0;
}

absl::StatusOr<std::vector<SliceCurve>> MeasureSliceConvergence(
    const scene::Scene& scene, const std::shared_ptr<const volume::HydrometeorFields>& fields,
    const std::function<void(double share)>& progress) {
  renderers::SceneRenderer renderer;
  std::vector<SliceCurve> curves;
  double done = 0.0;
  const auto step = [&] {
    progress(++done / static_cast<double>(accuracy::kTransportNames.size() * (kCounts.size() + 1)));
  };
  for (const auto& transport : accuracy::kTransportNames) {
    if (!accuracy::ShowsTransport(scene.rendering.technique, transport.value)) continue;
    scene::Scene drawn = scene;
    scene::MediumSettingsOf(&drawn.rendering.technique)->transport = transport.value;
    THUNDERHEAD_ASSIGN_OR_RETURN(const picture::LinearPicture limit,
                                 DrawWith(renderer, drawn, kLimit, fields));
    step();
    SliceCurve curve{transport, {}, 0.0};
    for (const int slices : kCounts) {
      THUNDERHEAD_ASSIGN_OR_RETURN(const picture::LinearPicture image,
                                   DrawWith(renderer, drawn, slices, fields));
      curve.points.push_back({slices, RelativeRmse(image, limit)});
      step();
    }
    curve.order = OrderOf(curve.points);
    curves.push_back(std::move(curve));
  }
  return curves;
}

std::string ToTable(const std::vector<SliceCurve>& curves) {
  std::string text = absl::StrFormat("relative RMSE against %d slices\n\n%-8s", kLimit, "slices");
  for (const SliceCurve& curve : curves)
    absl::StrAppendFormat(&text, " %12s", curve.transport.name);
  for (std::size_t i = 0; i < kCounts.size(); ++i) {
    absl::StrAppendFormat(&text, "\n%-8d", kCounts[i]);
    for (const SliceCurve& curve : curves) {
      absl::StrAppendFormat(&text, " %12.3g", curve.points[i].relative_rmse);
    }
  }
  absl::StrAppendFormat(&text, "\n%-8s", "order");
  for (const SliceCurve& curve : curves) absl::StrAppendFormat(&text, " %12.2f", curve.order);
  return text + "\n";
}

std::string ToJson(const Machine& machine, const std::vector<SliceCurve>& curves) {
  const std::string rows =
      absl::StrJoin(curves, ",\n", [](std::string* text, const SliceCurve& curve) {
        const std::string points =
            absl::StrJoin(curve.points, ", ", [](std::string* out, const SlicePoint& point) {
              absl::StrAppendFormat(out, "{\"slices\": %d, \"relative_rmse\": %.6g}", point.slices,
                                    point.relative_rmse);
            });
        absl::StrAppendFormat(text,
                              "    {\"transport\": \"%s\", \"order\": %.4g, \"points\": [%s]}",
                              curve.transport.name, curve.order, points);
      });
  return absl::StrCat("{\n  \"machine\": ", ToJson(machine), ",\n  \"rows\": [\n", rows,
                      "\n  ]\n}\n");
}

std::string ToCsv(const std::vector<SliceCurve>& curves) {
  std::string text = "transport,slices,relative_rmse\n";
  for (const SliceCurve& curve : curves) {
    for (const SlicePoint& point : curve.points) {
      absl::StrAppendFormat(&text, "%s,%d,%.6g\n", curve.transport.name, point.slices,
                            point.relative_rmse);
    }
  }
  return text;
}

std::string ToSvg(const std::string& title, const std::vector<SliceCurve>& curves) {
  constexpr std::array<const char*, accuracy::kTransportNames.size()> kColors = {
      "#d9730d", "#1f6fb4", "#3a8f4a"};
  constexpr std::array<const char*, accuracy::kTransportNames.size()> kColorNames = {
      "orange", "blue", "green"};
  std::vector<double> slices;
  std::vector<double> errors;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < curves.size(); ++i) {
    for (const SlicePoint& point : curves[i].points) {
      slices.push_back(point.slices);
      errors.push_back(std::max(point.relative_rmse, kMinSliceError));
    }
    names.push_back(absl::StrFormat("%s: %s, order %.2f", kColorNames[i], curves[i].transport.name,
                                    curves[i].order));
  }
  LogPlot plot(slices, errors, absl::StrCat(title, ": relative RMSE against slices"),
               absl::StrJoin(names, "; "));
  for (std::size_t i = 0; i < curves.size(); ++i) {
    std::vector<std::pair<double, double>> line;
    for (const SlicePoint& point : curves[i].points) {
      line.emplace_back(point.slices, std::max(point.relative_rmse, kMinSliceError));
    }
    plot.Line(line, kColors[i]);
    for (const auto& [x, y] : line) {
      plot.Dot(x, y, 4, kColors[i], kColors[i], absl::StrFormat("%g slices: %.3g", x, y));
    }
  }
  return plot.Svg();
}

}  // namespace thunderhead::measure
