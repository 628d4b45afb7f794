#include "tests/support/border_files.h"

#include <algorithm>
#include <cmath>

#include "base/status.h"
#include "base/whole_file.h"
#include "netcdf/netcdf_writer.h"
#include "physics/field_pattern.h"

namespace thunderhead::testing {
namespace {

constexpr int kColumns = 36;
constexpr int kRows = 18;
constexpr double kSide_deg = 10.0;

using Numbers = std::vector<double>;

// A netCDF file that is being written. Each variable has its own dimension.
class BinnedFile {
 public:
  explicit BinnedFile(const std::string& path) : path_(path), file_(path) {}

  void Add(const char* name, nc_type type, const Numbers& values) {
    const std::string dimension = std::string("of_") + name;
    const int id = file_.Dimension(dimension.c_str(), values.size());
    added_.push_back({file_.Variable(name, type, {id}), values});
  }

  void Write() {
    file_.EndDefinitions();
    for (const auto& [variable, values] : added_) file_.Values(variable, values);
    const std::string bytes = file_.Take();
    THUNDERHEAD_CHECK(file_.Good(), "the file is encoded");
    THUNDERHEAD_CHECK(base::WriteWholeFile(path_, bytes).ok(), path_);
  }

 private:
  struct Added {
    int variable = 0;
    Numbers values;
  };

  const std::string path_;
  netcdf::NetcdfWriter file_;
  std::vector<Added> added_;
};

// Returns the value of the signed 16-bit integer that has the same bits.
double Short(int coordinate) { return coordinate > 32'767 ? coordinate - 65'536 : coordinate; }

void Write(const std::string& path, std::vector<BorderSegment> segments, bool coasts) {
  std::ranges::stable_sort(segments, {}, &BorderSegment::bin);
  Numbers first_segment(kColumns * kRows, 0.0);
  Numbers segment_count(kColumns * kRows, 0.0);
  Numbers first_point, points, levels, embedded, polygons, areas, east, north;
  for (const BorderSegment& segment : segments) {
    const auto bin = static_cast<std::size_t>(segment.bin);
    if (segment_count[bin]++ == 0.0) first_segment[bin] = static_cast<double>(first_point.size());
    first_point.push_back(static_cast<double>(east.size()));
    points.push_back(segment.declared_points != 0 ? segment.declared_points
                                                  : static_cast<double>(segment.points.size()));
    levels.push_back(segment.level);
    // The bit fields are the number of points, the level, and the sides of the bin at which the
    // segment enters and exits. The readers of lines ignore the sides.
    embedded.push_back(points.back() * 512 + segment.level * 64 + 2 * 8 + 1);
    polygons.push_back(static_cast<double>(areas.size()));
    areas.push_back(segment.area_km2);
    for (const glm::ivec2& point : segment.points) {
      east.push_back(Short(point.x));
      north.push_back(Short(point.y));
    }
  }
  BinnedFile file(path);
  file.Add("Bin_size_in_minutes", NC_INT, {60.0 * kSide_deg});
  file.Add("N_bins_in_360_longitude_range", NC_INT, {kColumns});
  file.Add("N_bins_in_180_degree_latitude_range", NC_INT, {kRows});
  file.Add("Id_of_first_segment_in_a_bin", NC_INT, first_segment);
  file.Add("N_segments_in_a_bin", NC_SHORT, segment_count);
  file.Add("Id_of_first_point_in_a_segment", NC_INT, first_point);
  if (coasts) {
    file.Add("Embedded_npts_levels_exit_entry_for_a_segment", NC_INT, embedded);
    file.Add("Id_of_GSHHS_ID", NC_INT, polygons);
    file.Add("The_km_squared_area_of_polygons", NC_DOUBLE, areas);
  } else {
    file.Add("N_points_for_a_segment", NC_SHORT, points);
    file.Add("Hierarchial_level_of_a_segment", NC_SHORT, levels);
  }
  file.Add("Relative_longitude_from_SW_corner_of_bin", NC_SHORT, east);
  file.Add("Relative_latitude_from_SW_corner_of_bin", NC_SHORT, north);
  file.Write();
}

}  // namespace

BorderSegment SegmentThrough(const std::vector<glm::dvec2>& longitudes_and_latitudes, int level) {
  glm::dvec2 middle(0.0);
  for (const glm::dvec2& place : longitudes_and_latitudes) {
    middle += place / static_cast<double>(longitudes_and_latitudes.size());
  }
  const int column = static_cast<int>(std::floor(std::fmod(middle.x + 360.0, 360.0) / kSide_deg));
  const int row = static_cast<int>(std::floor((90.0 - middle.y) / kSide_deg));
  BorderSegment segment{.bin = kColumns * row + column, .level = level, .points = {}};
  for (const glm::dvec2& place : longitudes_and_latitudes) {
    const double east = std::fmod(place.x + 360.0, 360.0) - kSide_deg * column;
    const double north = place.y - (90.0 - kSide_deg * (row + 1));
    segment.points.emplace_back(std::lround(65'535.0 * east / kSide_deg),
                                std::lround(65'535.0 * north / kSide_deg));
  }
  return segment;
}

void WriteBorderFiles(const std::string& folder, char letter,
                      const std::vector<BorderSegment>& coasts,
                      const std::vector<BorderSegment>& borders) {
  const std::string ending = std::string("_") + letter + ".nc";
  Write(folder + "/binned_GSHHS" + ending, coasts, true);
  Write(folder + "/binned_border" + ending, borders, false);
}

float PaintedAt(const volume::BorderMap& map, const glm::dvec2& place_m) {
  if (map.nearest.empty()) return 0.0F;
  return physics::glsl::border_paint(volume::NearestBorder(map, place_m),
                                     static_cast<float>(map.grid.texel_m), {1.0F, 1.0F}, 1.0F);
}

}  // namespace thunderhead::testing
