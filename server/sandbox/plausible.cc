#include "sandbox/plausible.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/time/civil_time.h"
#include "base/status.h"
#include "glm/geometric.hpp"

namespace thunderhead::sandbox {
namespace {

// These limits are far larger than any storm needs, but small enough for arithmetic in single
// precision.
constexpr int kMaxCells = 2'000'000;  // maximum number of cells along one axis
constexpr double kFarthest_m = 1e9;

absl::Status Require(bool condition, const std::string& what) {
  if (condition) return absl::OkStatus();
  return absl::InvalidArgumentError(what);
}

bool Within(double value, double low, double high) {
  return std::isfinite(value) && value >= low && value <= high;
}

template <typename Enum>
bool AtMost(Enum value, Enum last) {
  return static_cast<int>(value) >= 0 && static_cast<int>(value) <= static_cast<int>(last);
}

bool IsKnown(physics::Hydrometeor hydrometeor) {
  return std::ranges::find(physics::kHydrometeors, hydrometeor) != physics::kHydrometeors.end();
}

bool AreCells(const glm::ivec3& cells) {
  return std::min({cells.x, cells.y, cells.z}) >= 1 &&
         std::max({cells.x, cells.y, cells.z}) <= kMaxCells;
}

// Returns whether `question` is true for all values. Within a block of values the loop has no
// branch, so that the compiler can vectorise it.
template <typename Question>
bool AllOf(std::span<const float> values, const Question& question) {
  constexpr std::size_t kBlock = 4096;
  while (!values.empty()) {
    const std::span<const float> block = values.first(std::min(kBlock, values.size()));
    unsigned wrong = 0;
    for (const float value : block) wrong |= question(value) ? 0U : 1U;
    if (wrong != 0) return false;
    values = values.subspan(block.size());
  }
  return true;
}

bool AllFinite(std::span<const float> values, float least) {
  // The first comparison fails for NaN, so NaN is refused too.
  return AllOf(values, [least](float value) { return (value >= least) & (value <= 3.4e38F); });
}

absl::Status CheckGrid(const volume::RegularGrid& grid) {
  THUNDERHEAD_RETURN_IF_ERROR(Require(AreCells(grid.cells), "the number of cells"));
  for (int axis = 0; axis < 3; ++axis) {
    const bool sound = Within(grid.spacing_m[axis], 1e-6, kFarthest_m) &&
                       Within(grid.low_corner_m[axis], -kFarthest_m, kFarthest_m);
    THUNDERHEAD_RETURN_IF_ERROR(Require(sound, "the size of cells"));
  }
  return absl::OkStatus();
}

// Returns whether every cell with particles has a radius.
bool CoverParticles(const volume::ParticleSizes& sizes, const std::vector<float>& concentration) {
  if (sizes.Empty()) return true;
  if (sizes.first_cell > concentration.size() ||
      sizes.inverse_radius.size() > concentration.size() - sizes.first_cell) {
    return false;
  }
  const auto is_empty = [](float value) { return value == 0.0F; };
  const std::span<const float> all = concentration;
  return AllOf(all.first(sizes.first_cell), is_empty) &&
         AllOf(all.subspan(sizes.EndCell()), is_empty);
}

absl::Status CheckField(const volume::HydrometeorField& field, std::size_t cells) {
  const std::vector<float>& values = field.concentration_kg_per_m3;
  const volume::FieldStatistics& statistics = field.statistics;
  const bool kinds = IsKnown(field.hydrometeor) && AtMost(field.quantity, volume::kLastQuantity) &&
                     AtMost(field.sizes.origin, volume::kLastSizeOrigin);
  THUNDERHEAD_RETURN_IF_ERROR(Require(kinds, "the kind of a field"));
  const bool counts = std::isfinite(statistics.minimum) && std::isfinite(statistics.maximum) &&
                      std::isfinite(statistics.mean_water_path_kg_per_m2) &&
                      std::isfinite(statistics.maximum_water_path_kg_per_m2) &&
                      statistics.negative_cells >= 0 && statistics.missing_cells >= 0;
  THUNDERHEAD_RETURN_IF_ERROR(Require(counts, "the statistics of a field"));
  const bool sound = (values.empty() || values.size() == cells) && AllFinite(values, 0.0F);
  THUNDERHEAD_RETURN_IF_ERROR(Require(sound, "the values of a field"));
  return Require(CoverParticles(field.sizes, values) && std::isfinite(field.sizes.mean_radius_m),
                 "the sizes of particles");
}

bool IsInside(const volume::CellBox& box, const glm::ivec3& cells) {
  for (int axis = 0; axis < 3; ++axis) {
    if (box.low[axis] < 0 || box.high[axis] > cells[axis]) return false;
  }
  return true;
}

absl::Status CheckGround(const volume::HydrometeorFields& fields, std::size_t columns) {
  const volume::LandSurface& land = fields.land;
  bool sound =
      fields.terrain_height_m.size() == columns && AllFinite(fields.terrain_height_m, -1e6F) &&
      (land.Empty() || land.texels.size() == columns) && Within(land.mean_albedo, 0.0, 1.0);
  for (int channel = 0; channel < 3; ++channel) {
    sound = sound && Within(land.mean_reflectance[channel], 0.0, 1.0);
  }
  return Require(sound, "the ground");
}

absl::Status CheckMotion(const volume::AirMotion& motion, std::size_t cells) {
  const bool sizes = (motion.turbulence.empty() || motion.turbulence.size() == cells) &&
                     (motion.ascent.empty() || motion.ascent.size() == cells);
  return Require(sizes && AtMost(motion.source, volume::kLastTurbulenceSource) &&
                     std::isfinite(motion.shear_m_per_s.x) &&
                     std::isfinite(motion.shear_m_per_s.y) &&
                     glm::length(motion.steering_m_per_s) <= volume::kMaxSteering_m_per_s &&
                     std::isfinite(motion.time_s),
                 "the motion of the air");
}

absl::Status CheckAir(const volume::AirDensity& air, const glm::ivec3& cells) {
  const glm::ivec2 blocks = air.blocks;
  bool sound = air.Empty();
  if (!sound && std::min(blocks.x, blocks.y) >= 1 &&
      std::max(blocks.x, blocks.y) <= volume::kAirBlocks) {
    const auto values = static_cast<std::size_t>(blocks.x * blocks.y) * cells.z;
    sound = air.kg_per_m3.size() == values &&
            AllFinite(air.kg_per_m3, std::numeric_limits<float>::min());
  }
  return Require(sound, "the density of the air");
}

}  // namespace

absl::Status CheckPlausible(const storm_files::StormFile& file) {
  for (const storm_files::StormFile& other : file.others) {
    THUNDERHEAD_RETURN_IF_ERROR(Require(other.others.empty(), "the number of storms"));
    THUNDERHEAD_RETURN_IF_ERROR(CheckPlausible(other));
  }
  static const absl::Time kFirst = absl::FromCivil(absl::CivilYear(0), absl::UTCTimeZone());
  static const absl::Time kLast = absl::FromCivil(absl::CivilYear(10'000), absl::UTCTimeZone());
  const bool in_time = std::ranges::all_of(
      file.times, [](absl::Time time) { return time >= kFirst && time < kLast; });
  THUNDERHEAD_RETURN_IF_ERROR(Require(in_time, "the times"));
  const bool is_part = !file.part.of.empty();
  const bool may_be_empty = is_part && file.part.at_all_times;
  THUNDERHEAD_RETURN_IF_ERROR(
      Require((may_be_empty || !file.times.empty()) && file.times.size() <= storm_files::kMaxTimes,
              "the number of times"));
  // The description of a file that is only a part of a time has no other members to check.
  if (is_part) return absl::OkStatus();
  THUNDERHEAD_RETURN_IF_ERROR(Require(AreCells(file.cells), "the number of cells"));
  THUNDERHEAD_RETURN_IF_ERROR(
      Require(Within(file.dx_m, 1e-6, kFarthest_m) && Within(file.dy_m, 1e-6, kFarthest_m),
              "the size of cells"));
  const bool fields = !file.fields.empty() && file.fields.size() <= physics::kHydrometeorCount &&
                      std::ranges::all_of(file.fields, IsKnown);
  THUNDERHEAD_RETURN_IF_ERROR(Require(fields, "the fields"));
  const bool place = Within(file.latitude_deg.value_or(0.0), -90.0, 90.0) &&
                     Within(file.longitude_deg.value_or(0.0), -360.0, 360.0);
  const bool middles = (file.middles.empty() || file.middles.size() == file.times.size()) &&
                       std::ranges::all_of(file.middles, [](const volume::EarthPlace& middle) {
                         return Within(middle.latitude_deg, -90.0, 90.0) &&
                                Within(middle.longitude_deg, -360.0, 360.0);
                       });
  const bool projections = file.projections.empty() || file.projections.size() == file.times.size();
  return Require(place && middles && projections, "the place");
}

absl::Status CheckPlausible(const storm_files::VerticalGrid& grid) {
  return Require(grid.cells >= 1 && grid.cells <= kMaxCells &&
                     Within(grid.low_m, -kFarthest_m, kFarthest_m) &&
                     Within(grid.spacing_m, 1e-6, kFarthest_m),
                 "the heights");
}

absl::Status CheckPlausible(const volume::HydrometeorFields& fields, const glm::ivec2& columns) {
  THUNDERHEAD_RETURN_IF_ERROR(CheckGrid(fields.grid));
  const glm::ivec3 cells = fields.grid.cells;
  THUNDERHEAD_RETURN_IF_ERROR(
      Require(glm::ivec2(cells) == columns,
              "the number of columns, which was different before (was the file replaced?)"));
  for (const volume::HydrometeorField& field : fields.fields) {
    THUNDERHEAD_RETURN_IF_ERROR(CheckField(field, fields.grid.CellCount()));
  }
  THUNDERHEAD_RETURN_IF_ERROR(
      Require(IsInside(fields.condensate, cells), "the box of the condensate"));
  THUNDERHEAD_RETURN_IF_ERROR(
      CheckGround(fields, static_cast<std::size_t>(cells.x) * static_cast<std::size_t>(cells.y)));
  THUNDERHEAD_RETURN_IF_ERROR(CheckAir(fields.air, cells));
  return CheckMotion(fields.motion, fields.grid.CellCount());
}

}  // namespace thunderhead::sandbox
