#include "measure/look.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <thread>

#include "base/srgb.h"
#include "frame/white_balance.h"
#include "glm/common.hpp"
#include "glm/geometric.hpp"
#include "glm/vector_relational.hpp"
#include "physics/chunked_work.h"
#include "scene/drawn_fields.h"
#include "scene/place_seen.h"
#include "scene/view.h"
#include "volume/strongest_core.h"

namespace thunderhead::measure {
namespace {

constexpr float kCovered = 0.95F;
constexpr double kTowerRadius = 1.0 / 2.0;  // radii and heights as shares of the core's height
constexpr double kTowerFoot = 1.0 / 6.0;
constexpr double kBaseRadius = 1.0 / 3.0;
constexpr double kBaseHeight = 1.0 / 4.0;
constexpr double kOwnShadow = 1.0 / 8.0;
constexpr double kHighestBase_m = 2000.0;
// Luminance of half of the first 8-bit step.
const double kDarkest = base::LinearOfSrgb(0.5 / 255.0);

class Places {
 public:
  Places(const scene::Scene& scene, const volume::HydrometeorFields& fields,
         const volume::StormCore& core)
      : scene_(scene),
        fields_(fields),
        core_(core),
        drawn_(scene::DrawnFieldsOf(scene, fields)),
        view_(scene::ViewOf(scene, fields)),
        towards_sun_(scene::Direction(scene.sun.azimuth_deg, scene.sun.elevation_deg)) {}

  // Returns the region of the pixel at device coordinates `at`, from -1 to 1, with y upwards.
  Region At(const glm::dvec2& at) const {
    const glm::dvec3 origin_m = view_.eye_m + at.x * view_.half_width_m * view_.right +
                                at.y * view_.half_height_m * view_.up;
    const glm::dvec3 direction =
        glm::normalize(view_.forward + at.x * view_.tan_half_width * view_.right +
                       at.y * view_.tan_half_height * view_.up);
    const glm::dvec3 place_m = scene::PlaceSeen(scene_, fields_, origin_m, direction);
    const double away_m = glm::distance(glm::dvec2(place_m), core_.place_m);
    const double above_m = place_m.z - core_.ground_m;
    const double height_m = core_.Height_m();
    const bool tower = away_m < kTowerRadius * height_m && above_m > kTowerFoot * height_m;
    const bool base = away_m < kBaseRadius * height_m &&
                      above_m < std::min(kBaseHeight * height_m, kHighestBase_m);
    if (!tower && !base) return Region::kNeither;
    const bool sunlit = IsSunlit(place_m);
    if (tower && sunlit) return Region::kTower;
    return base && !sunlit ? Region::kBase : Region::kNeither;
  }

 private:
  bool IsSunlit(const glm::dvec3& place_m) const {
    const volume::RegularGrid& grid = fields_.grid;
    if (towards_sun_.z <= 0.0) return false;
    const double step_m = 0.5 * std::min({grid.spacing_m.x, grid.spacing_m.y, grid.spacing_m.z});
    const double highest_m = grid.HighCorner_m().z;
    double depth = 0.0;
    for (double along_m = kOwnShadow * core_.Height_m() + step_m / 2.0; depth < 1.0;
         along_m += step_m) {
      const glm::dvec3 point_m = place_m + along_m * towards_sun_;
      if (point_m.z >= highest_m) return true;
      const glm::ivec3 cell(glm::floor((point_m - grid.low_corner_m) / grid.spacing_m));
      if (glm::any(glm::lessThan(cell, glm::ivec3(0))) ||
          glm::any(glm::greaterThanEqual(cell, grid.cells))) {
        continue;
      }
      float extinction_per_m = 0.0F;
      for (const scene::DrawnField& drawn : drawn_) {
        volume::AddExtinction(fields_.fields[drawn.index], drawn.mass_extinction,
                              grid.Offset(cell.x, cell.y, cell.z), 1, &extinction_per_m);
      }
      depth += step_m * static_cast<double>(extinction_per_m);
    }
    return false;
  }

  const scene::Scene& scene_;
  const volume::HydrometeorFields& fields_;
  const volume::StormCore core_;
  const std::vector<scene::DrawnField> drawn_;
  const scene::View view_;
  const glm::dvec3 towards_sun_;
};

// Returns the percentile `share` (0 to 1) of `values`, which must not be empty.
double Percentile(std::vector<double> values, double share) {
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

double StopsBetween(const std::vector<double>& values, double low, double high) {
  return std::log2(Percentile(values, high) / Percentile(values, low));
}

LookFigures FiguresOf(const std::vector<Region>& regions, const std::vector<double>& luminance) {
  std::vector<double> tower;
  std::vector<double> base;
  for (std::size_t i = 0; i < regions.size(); ++i) {
    if (regions[i] == Region::kTower) tower.push_back(luminance[i]);
    if (regions[i] == Region::kBase) base.push_back(luminance[i]);
  }
  LookFigures figures;
  figures.tower_pixels = static_cast<int>(tower.size());
  figures.base_pixels = static_cast<int>(base.size());
  figures.frame_stops = StopsBetween(luminance, 0.01, 0.99);
  if (figures.tower_pixels < kFewestPixels) return figures;
  figures.tower_stops = StopsBetween(tower, 0.05, 0.95);
  if (figures.base_pixels < kFewestPixels) return figures;
  figures.base_share = Percentile(base, 0.5) / Percentile(tower, 0.5);
  return figures;
}

}  // namespace

std::vector<Region> RegionsOf(const scene::Scene& scene, const volume::HydrometeorFields& fields,
                              const std::vector<float>& opacity) {
  std::vector<Region> regions(opacity.size(), Region::kNeither);
  const auto core = volume::StrongestCore(fields);
  if (!core.has_value()) return regions;
  const Places places(scene, fields, *core);
  const int width = scene.output.width_px;
  const int height = scene.output.height_px;
  const int threads = static_cast<int>(std::max(std::thread::hardware_concurrency(), 1U));
  physics::ForEachChunk(height, {.threads = threads}, [&](int y) {
    for (int x = 0; x < width; ++x) {
      const auto pixel = static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                         static_cast<std::size_t>(x);
      if (opacity[pixel] < kCovered) continue;
      regions[pixel] = places.At({2.0 * (x + 0.5) / width - 1.0, 1.0 - 2.0 * (y + 0.5) / height});
    }
  });
  return regions;
}

LookFigures FiguresOf(const std::vector<Region>& regions, const picture::LinearPicture& picture) {
  std::vector<double> luminance;
  luminance.reserve(picture.radiance.size());
  for (const glm::vec3& pixel : picture.radiance) {
    luminance.push_back(std::max(static_cast<double>(frame::LuminanceOf(pixel)), 1e-9));
  }
  return FiguresOf(regions, luminance);
}

LookFigures FiguresOf(const std::vector<Region>& regions, const frame::RgbImage& display) {
  std::vector<double> luminance;
  luminance.reserve(display.rgb.size() / 3);
  for (std::size_t i = 0; i + 2 < display.rgb.size(); i += 3) {
    const double shown = 0.2126 * base::LinearOfSrgbByte(display.rgb[i]) +
                         0.7152 * base::LinearOfSrgbByte(display.rgb[i + 1]) +
                         0.0722 * base::LinearOfSrgbByte(display.rgb[i + 2]);
    luminance.push_back(std::max(shown, kDarkest));
  }
  return FiguresOf(regions, luminance);
}

}  // namespace thunderhead::measure
