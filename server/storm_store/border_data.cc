#include "storm_store/border_data.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>

#include "absl/strings/str_cat.h"
#include "base/status.h"
#include "base/stopwatch.h"
#include "glm/common.hpp"
#include "glm/geometric.hpp"
#include "netcdf/netcdf_file.h"
#include "spdlog/spdlog.h"

namespace thunderhead::storm_store {
namespace {

// One of the data sets, and the tolerance in m with which its lines were simplified.
struct Detail {
  char letter;
  double tolerance_m;
};
constexpr std::array kDetails = {Detail{'f', 40.0}, Detail{'h', 200.0}, Detail{'i', 1000.0},
                                 Detail{'l', 5000.0}, Detail{'c', 25'000.0}};

constexpr int kTexels = 1024;  // number of texels along the map's longer side
// The map extends beyond the domain by the length of the domain's longer side, within these limits.
constexpr double kLeastMargin_m = 100e3;
constexpr double kMostMargin_m = 200e3;

// Islands and lakes with a smaller area than this are left out, because their lines would cover
// their whole area.
constexpr double kLeastArea_texels = 64.0;

// The data's lines are straight in degrees of latitude and longitude, and therefore curved on the
// map. Lines are split into pieces of at most this length, so that the map shows the curves.
constexpr double kLongestPiece_deg = 0.1;
// A piece that is longer than this on the map crosses the seam of the map projection and must not
// be drawn.
constexpr double kLongestPiece_m = 50e3;

// Number of probed places along each side of the grid. The bins there and their neighbours are
// read.
constexpr int kProbes = 256;

// Borders between states cover a smaller share of the ground's colour than borders between
// countries.
constexpr float kInnerStrength = 0.6F;

std::string FileOf(const std::string& folder, const char* kind, char letter) {
  return absl::StrCat(folder, "/binned_", kind, "_", std::string(1, letter), ".nc");
}

// The bins of a file: squares of latitude and longitude. Rows are counted from the north pole, and
// columns eastwards from Greenwich.
struct Bins {
  double side_deg = 0.0;
  int columns = 0;
  int rows = 0;

  int Of(const volume::EarthPlace& place) const {
    const double east =
        place.longitude_deg < 0.0 ? place.longitude_deg + 360.0 : place.longitude_deg;
    const int column = std::clamp(static_cast<int>(east / side_deg), 0, columns - 1);
    const int row =
        std::clamp(static_cast<int>((90.0 - place.latitude_deg) / side_deg), 0, rows - 1);
    return row * columns + column;
  }
  volume::EarthPlace SouthWestOf(int bin) const {
    const int row = bin / columns;
    return {90.0 - side_deg * (row + 1), side_deg * (bin % columns)};
  }
};

// Returns the indices of the bins that overlap the grid, and of their neighbours.
std::vector<int> BinsUnder(const Bins& bins, const volume::MapProjection& projection,
                           const volume::BorderGrid& grid) {
  std::vector<bool> wanted(static_cast<std::size_t>(bins.columns) *
                           static_cast<std::size_t>(bins.rows));
  const glm::dvec2 step_m = glm::dvec2(grid.texels) * grid.texel_m / static_cast<double>(kProbes);
  for (int y = 0; y <= kProbes; ++y) {
    for (int x = 0; x <= kProbes; ++x) {
      const std::optional<volume::EarthPlace> place =
          projection.PlaceOf(grid.low_m + step_m * glm::dvec2(x, y));
      if (place.has_value()) wanted[static_cast<std::size_t>(bins.Of(*place))] = true;
    }
  }
  std::vector<int> found;
  for (int bin = 0; bin < static_cast<int>(wanted.size()); ++bin) {
    const int row = bin / bins.columns;
    const int column = bin % bins.columns;
    bool near = false;
    for (int j = std::max(row - 1, 0); j <= std::min(row + 1, bins.rows - 1); ++j) {
      for (int i = column - 1; i <= column + 1; ++i) {
        const int wrapped = (i + bins.columns) % bins.columns;
        near = near || wanted[static_cast<std::size_t>(j * bins.columns + wrapped)];
      }
    }
    if (near) found.push_back(bin);
  }
  return found;
}

// One of the binned files, with the data about its segments.
class BinnedFile {
 public:
  static absl::StatusOr<BinnedFile> Open(const std::string& path) {
    THUNDERHEAD_ASSIGN_OR_RETURN(netcdf::NetcdfFile file, netcdf::NetcdfFile::Open(path));
    BinnedFile opened(std::move(file));
    THUNDERHEAD_ASSIGN_OR_RETURN(const int minutes, opened.Number("Bin_size_in_minutes"));
    THUNDERHEAD_ASSIGN_OR_RETURN(opened.bins_.columns,
                                 opened.Number("N_bins_in_360_longitude_range"));
    THUNDERHEAD_ASSIGN_OR_RETURN(opened.bins_.rows,
                                 opened.Number("N_bins_in_180_degree_latitude_range"));
    opened.bins_.side_deg = minutes / 60.0;
    if (minutes <= 0 || minutes * opened.bins_.columns != 360 * 60 ||
        minutes * opened.bins_.rows != 180 * 60) {
      return opened.Damaged();
    }
    THUNDERHEAD_ASSIGN_OR_RETURN(opened.first_segment_,
                                 opened.Integers("Id_of_first_segment_in_a_bin"));
    THUNDERHEAD_ASSIGN_OR_RETURN(opened.segment_count_, opened.Integers("N_segments_in_a_bin"));
    THUNDERHEAD_ASSIGN_OR_RETURN(opened.first_point_,
                                 opened.Integers("Id_of_first_point_in_a_segment"));
    const auto bins = static_cast<std::size_t>(opened.bins_.columns * opened.bins_.rows);
    if (opened.first_segment_.size() != bins || opened.segment_count_.size() != bins) {
      return opened.Damaged();
    }
    return opened;
  }

  const Bins& AllBins() const { return bins_; }
  bool Has(const std::string& variable) const { return file_.HasVariable(variable); }

  // Reads a variable of whole numbers.
  absl::StatusOr<std::vector<int>> Integers(const std::string& variable) const {
    THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<double> read, file_.ReadDoubles(variable));
    std::vector<int> values;
    values.reserve(read.size());
    for (const double value : read) {
      if (!(std::abs(value) <= std::numeric_limits<int>::max())) return Damaged();
      values.push_back(static_cast<int>(value));
    }
    return values;
  }
  absl::StatusOr<std::vector<double>> Doubles(const std::string& variable) const {
    return file_.ReadDoubles(variable);
  }

  std::size_t Segments() const { return first_point_.size(); }

  // Calls `take(segment, points in degrees)` for each segment of these bins.
  template <typename Take>
  absl::Status ForEach(const std::vector<int>& bins, const std::vector<int>& points_of_segment,
                       const Take& take) const {
    std::size_t first = std::numeric_limits<std::size_t>::max();
    std::size_t end = 0;
    for (const int bin : bins) {
      THUNDERHEAD_ASSIGN_OR_RETURN(const Range segments, SegmentsOf(bin));
      for (std::size_t i = segments.first; i < segments.end; ++i) {
        if (first_point_[i] < 0 || points_of_segment[i] < 0) return Damaged();
        first = std::min(first, static_cast<std::size_t>(first_point_[i]));
        end = std::max(end, static_cast<std::size_t>(first_point_[i]) +
                                static_cast<std::size_t>(points_of_segment[i]));
      }
    }
    if (end <= first) return absl::OkStatus();
    THUNDERHEAD_ASSIGN_OR_RETURN(
        const std::vector<float> east,
        file_.ReadPart("Relative_longitude_from_SW_corner_of_bin", {first}, {end - first}));
    THUNDERHEAD_ASSIGN_OR_RETURN(
        const std::vector<float> north,
        file_.ReadPart("Relative_latitude_from_SW_corner_of_bin", {first}, {end - first}));
    std::vector<volume::EarthPlace> points;
    for (const int bin : bins) {
      const volume::EarthPlace corner = bins_.SouthWestOf(bin);
      THUNDERHEAD_ASSIGN_OR_RETURN(const Range segments, SegmentsOf(bin));
      for (std::size_t i = segments.first; i < segments.end; ++i) {
        points.clear();
        for (int j = 0; j < points_of_segment[i]; ++j) {
          const std::size_t at = static_cast<std::size_t>(first_point_[i] + j) - first;
          points.push_back(
              {corner.latitude_deg + Degrees(north[at]), corner.longitude_deg + Degrees(east[at])});
        }
        take(i, points);
      }
    }
    return absl::OkStatus();
  }

  absl::Status Damaged() const {
    return absl::DataLossError(
        absl::StrCat(file_.Path(), ": is not a binned file of GSHHG; install the package again"));
  }

 private:
  struct Range {
    std::size_t first = 0;
    std::size_t end = 0;
  };

  explicit BinnedFile(netcdf::NetcdfFile file) : file_(std::move(file)) {}

  absl::StatusOr<int> Number(const std::string& variable) const {
    THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<int> values, Integers(variable));
    if (values.size() != 1) return Damaged();
    return values.front();
  }

  absl::StatusOr<Range> SegmentsOf(int bin) const {
    const int first = first_segment_[static_cast<std::size_t>(bin)];
    const int count = segment_count_[static_cast<std::size_t>(bin)];
    if (count == 0) return Range{};
    if (first < 0 || count < 0 ||
        static_cast<std::size_t>(first) + static_cast<std::size_t>(count) > Segments()) {
      return Damaged();
    }
    return Range{static_cast<std::size_t>(first), static_cast<std::size_t>(first + count)};
  }

  // Converts a stored coordinate, in units of 1/65535 of a bin's side, to degrees. The files store
  // coordinates as signed shorts. One of the short values is netCDF's code for a missing value and
  // is therefore read as NaN.
  double Degrees(float stored) const {
    const int part = std::isnan(stored) ? -32'767 : static_cast<int>(stored);
    return bins_.side_deg * static_cast<std::uint16_t>(part) / 65'535.0;
  }

  netcdf::NetcdfFile file_;
  Bins bins_;
  std::vector<int> first_segment_;
  std::vector<int> segment_count_;
  std::vector<int> first_point_;
};

// Adds a line between points in degrees to the map, split where it crosses the map's seams.
void AddLine(const std::vector<volume::EarthPlace>& points, const volume::MapProjection& projection,
             float strength, std::vector<volume::BorderLine>& lines) {
  volume::BorderLine line{{}, strength};
  const auto end_line = [&] {
    if (line.points_m.size() > 1) lines.push_back(line);
    line.points_m.clear();
  };
  const auto go_to = [&](const volume::EarthPlace& place) {
    const std::optional<glm::dvec2> world_m = projection.WorldOf(place);
    const bool joined = world_m.has_value() && !line.points_m.empty() &&
                        glm::distance(line.points_m.back(), *world_m) < kLongestPiece_m;
    if (!joined) end_line();
    if (world_m.has_value()) line.points_m.push_back(*world_m);
  };
  for (std::size_t i = 0; i < points.size(); ++i) {
    const volume::EarthPlace& to = points[i];
    const volume::EarthPlace& from = points[i > 0 ? i - 1 : 0];
    const glm::dvec2 way(to.longitude_deg - from.longitude_deg,
                         to.latitude_deg - from.latitude_deg);
    const int parts = std::max(
        static_cast<int>(std::ceil(std::max(std::abs(way.x), std::abs(way.y)) / kLongestPiece_deg)),
        1);
    for (int part = 1; part <= parts; ++part) {
      const double share = static_cast<double>(part) / parts;
      go_to({from.latitude_deg + share * way.y, from.longitude_deg + share * way.x});
    }
  }
  end_line();
}

absl::Status AddCoasts(const std::string& path, const volume::MapProjection& projection,
                       const volume::BorderGrid& grid, std::vector<volume::BorderLine>& lines) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const BinnedFile file, BinnedFile::Open(path));
  // The number of points begins at bit 9 and the level at bit 6. The lower bits are needed only for
  // filling polygons.
  THUNDERHEAD_ASSIGN_OR_RETURN(std::vector<int> points,
                               file.Integers("Embedded_npts_levels_exit_entry_for_a_segment"));
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<int> polygons, file.Integers("Id_of_GSHHS_ID"));
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<double> areas_km2,
                               file.Doubles("The_km_squared_area_of_polygons"));
  if (points.size() != file.Segments() || polygons.size() != file.Segments()) return file.Damaged();
  constexpr int kGroundedIce = 6;  // the grounding line under Antarctica's ice shelves; the
                                   // shelves' front has its own line
  std::vector<int> levels;
  for (int& embedded : points) {
    levels.push_back((embedded >> 6) & 7);
    embedded >>= 9;
  }
  const double least_km2 = kLeastArea_texels * grid.texel_m * grid.texel_m * 1e-6;
  return file.ForEach(BinsUnder(file.AllBins(), projection, grid), points,
                      [&](std::size_t segment, const std::vector<volume::EarthPlace>& places) {
                        const auto polygon = static_cast<std::size_t>(polygons[segment]);
                        const bool small =
                            polygon < areas_km2.size() && areas_km2[polygon] < least_km2;
                        if (small || levels[segment] == kGroundedIce) return;
                        AddLine(places, projection, 1.0F, lines);
                      });
}

absl::Status AddBorders(const std::string& path, const volume::MapProjection& projection,
                        const volume::BorderGrid& grid, std::vector<volume::BorderLine>& lines) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const BinnedFile file, BinnedFile::Open(path));
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<int> points,
                               file.Integers("N_points_for_a_segment"));
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<int> levels,
                               file.Integers("Hierarchial_level_of_a_segment"));
  if (points.size() != file.Segments() || levels.size() != file.Segments()) return file.Damaged();
  constexpr int kStates = 2;  // level 1: borders between countries; 2: between states; 3: at sea
  return file.ForEach(BinsUnder(file.AllBins(), projection, grid), points,
                      [&](std::size_t segment, const std::vector<volume::EarthPlace>& places) {
                        if (levels[segment] > kStates) return;
                        AddLine(places, projection,
                                levels[segment] == kStates ? kInnerStrength : 1.0F, lines);
                      });
}

}  // namespace

volume::BorderGrid BorderGridOf(const volume::RegularGrid& grid) {
  const glm::dvec2 size_m = glm::dvec2(grid.cells) * glm::dvec2(grid.spacing_m);
  const double margin_m = std::clamp(std::max(size_m.x, size_m.y), kLeastMargin_m, kMostMargin_m);
  const glm::dvec2 all_m = size_m + 2.0 * margin_m;
  const double texel_m = std::max(all_m.x, all_m.y) / kTexels;
  return {glm::dvec2(grid.low_corner_m) - margin_m, texel_m,
          glm::ivec2(glm::ceil(all_m / texel_m - 1e-6)), 0.5 * margin_m};
}

std::shared_ptr<BorderData> BorderData::Find(const std::string& folder) {
  std::string found;
  for (const Detail& detail : kDetails) {
    std::error_code error;
    if (std::filesystem::exists(FileOf(folder, "GSHHS", detail.letter), error) &&
        std::filesystem::exists(FileOf(folder, "border", detail.letter), error)) {
      found.push_back(detail.letter);
    }
  }
  if (found.empty()) return nullptr;
  return std::shared_ptr<BorderData>(new BorderData(folder, found));
}

absl::StatusOr<std::vector<volume::BorderLine>> BorderData::LinesOf(
    const volume::MapProjection& projection, const volume::BorderGrid& grid) const {
  char letter = details_.front();
  for (const Detail& detail : kDetails) {
    const bool is_there = details_.find(detail.letter) != std::string::npos;
    if (is_there && detail.tolerance_m <= grid.texel_m) letter = detail.letter;
  }
  std::vector<volume::BorderLine> lines;
  THUNDERHEAD_RETURN_IF_ERROR(AddCoasts(FileOf(folder_, "GSHHS", letter), projection, grid, lines));
  THUNDERHEAD_RETURN_IF_ERROR(
      AddBorders(FileOf(folder_, "border", letter), projection, grid, lines));
  return lines;
}

std::shared_ptr<const volume::BorderMap> BorderData::MapOf(const StormInfo& storm,
                                                           std::size_t time_index,
                                                           const volume::RegularGrid& grid) {
  const std::optional<volume::MapProjection> projection = ProjectionOf(storm, time_index);
  if (!projection.has_value()) return nullptr;
  const volume::BorderGrid around = BorderGridOf(grid);
  const glm::dvec2 size_m = glm::dvec2(around.texels) * around.texel_m;
  const volume::EarthPlace middle = MiddleOf(storm, time_index).value_or(volume::EarthPlace());
  const Key key{ProjectionTextOf(storm, time_index),
                middle.latitude_deg,
                middle.longitude_deg,
                around.low_m.x,
                around.low_m.y,
                size_m.x,
                size_m.y};
  const std::lock_guard lock(mutex_);
  std::erase_if(maps_, [](const auto& made) { return made.second.expired(); });
  if (const auto made = maps_.find(key); made != maps_.end()) return made->second.lock();
  const base::Stopwatch stopwatch;
  const absl::StatusOr<std::vector<volume::BorderLine>> lines = LinesOf(*projection, around);
  if (!lines.ok()) {
    spdlog::warn("no coasts and borders: {}", std::string(lines.status().message()));
    return nullptr;
  }
  auto map = std::make_shared<const volume::BorderMap>(volume::MakeBorderMap(*lines, around));
  maps_[key] = map;
  spdlog::debug("coasts and borders of {}: {} lines in {} ms", storm.id, lines->size(),
                stopwatch.ElapsedMs());
  return map;
}

}  // namespace thunderhead::storm_store
