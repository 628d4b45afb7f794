#include "storm_files/wrf_place.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <span>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/status.h"
#include "spdlog/spdlog.h"
#include "storm_files/model_columns.h"

namespace thunderhead::storm_files {
namespace {

constexpr WrfUnit kNorth = {"degree_north"};
constexpr WrfUnit kEast = {"degree_east"};

// Middles that are closer than this are the same place. It is about 2 m, which is the precision of
// XLONG.
constexpr double kSamePlace_deg = 2e-5;

// Returns the mean of `values`. They can be longitudes, so each is first brought to within 180
// degrees of the first.
double MeanAngle_deg(std::span<const float> values) {
  double sum_deg = 0.0;
  for (const float value : values) {
    sum_deg += values[0] + std::remainder(static_cast<double>(value) - values[0], 360.0);
  }
  return sum_deg / static_cast<double>(values.size());
}

// The names of the variables with the coordinates.
struct Coordinates {
  std::string latitude;
  std::string longitude;
};

std::optional<Coordinates> FindCoordinates(const netcdf::NetcdfFile& file,
                                           const WrfLayout& layout) {
  for (const auto& [latitude, longitude] :
       std::initializer_list<std::pair<const char*, const char*>>{
           {"XLAT", "XLONG"}, {"lat", "lon"}, {"latitude", "longitude"}}) {
    if (!file.HasVariable(latitude) || !file.HasVariable(longitude)) continue;
    // Coordinates by other names than WRF's are used only if they fit.
    const bool named_by_wrf = std::string(latitude) == "XLAT";
    if (named_by_wrf || (HasShape(file, layout, latitude, layout.Columns(), Changes::kNever) &&
                         HasShape(file, layout, longitude, layout.Columns(), Changes::kNever))) {
      return Coordinates{latitude, longitude};
    }
  }
  return std::nullopt;
}

// Returns the mean of `variable` over the cells around the middle of the domain, at each of `count`
// records.
absl::StatusOr<std::vector<double>> MiddlesOf(const netcdf::NetcdfFile& file,
                                              const WrfLayout& layout, const std::string& variable,
                                              std::size_t record, std::size_t count) {
  const auto nx = static_cast<std::size_t>(layout.cells.x);
  const auto ny = static_cast<std::size_t>(layout.cells.y);
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<std::size_t> shape, file.Shape(variable));
  std::vector<std::size_t> start = {(ny - 1) / 2, (nx - 1) / 2};
  std::vector<std::size_t> lengths = {2 - ny % 2, 2 - nx % 2};
  const std::size_t cells = lengths[0] * lengths[1];
  const bool constant = shape.size() == start.size() || shape.front() == 1;
  if (shape.size() > start.size()) {
    start.insert(start.begin(), constant ? 0 : record);
    lengths.insert(lengths.begin(), constant ? 1 : count);
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<float> values,
                               file.ReadPart(variable, start, lengths));
  std::vector<double> middles_deg;
  for (std::size_t first = 0; first < values.size(); first += cells) {
    middles_deg.push_back(MeanAngle_deg(std::span(values).subspan(first, cells)));
  }
  if (constant) middles_deg.assign(count, middles_deg.front());
  return middles_deg;
}

bool IsPlace(const volume::EarthPlace& place) {
  return std::isfinite(place.latitude_deg) && std::isfinite(place.longitude_deg);
}

bool IsSame(const volume::EarthPlace& a, const volume::EarthPlace& b) {
  return std::abs(a.latitude_deg - b.latitude_deg) < kSamePlace_deg &&
         std::abs(std::remainder(a.longitude_deg - b.longitude_deg, 360.0)) < kSamePlace_deg;
}

// Returns an error if a place has values, and they are no latitude and longitude.
absl::Status CheckPlace(const netcdf::NetcdfFile& file, const Coordinates& names,
                        double latitude_deg, double longitude_deg) {
  if (!IsPlace({latitude_deg, longitude_deg}) || IsPlaceOnEarth(latitude_deg, longitude_deg)) {
    return absl::OkStatus();
  }
  return absl::InvalidArgumentError(absl::StrFormat(
      "%s: %s and %s place the domain at %.7g degrees north and %.7g degrees east, and there is no "
      "such place; correct them",
      file.Path(), names.latitude, names.longitude, latitude_deg, longitude_deg));
}

absl::StatusOr<std::vector<volume::EarthPlace>> PlacesAt(const netcdf::NetcdfFile& file,
                                                         const WrfLayout& layout,
                                                         const Coordinates& names,
                                                         std::size_t record, std::size_t count) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<double> latitudes_deg,
                               MiddlesOf(file, layout, names.latitude, record, count));
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<double> longitudes_deg,
                               MiddlesOf(file, layout, names.longitude, record, count));
  std::vector<volume::EarthPlace> places;
  for (std::size_t i = 0; i < count; ++i) {
    THUNDERHEAD_RETURN_IF_ERROR(CheckPlace(file, names, latitudes_deg[i], longitudes_deg[i]));
    places.push_back({latitudes_deg[i], std::remainder(longitudes_deg[i], 360.0)});
  }
  return places;
}

// Returns the middle at each time, or nothing if it stays at `first`. The outermost domain cannot
// move, so only its last time is compared with `first`.
absl::StatusOr<std::vector<volume::EarthPlace>> ReadMiddles(const netcdf::NetcdfFile& file,
                                                            const WrfLayout& layout,
                                                            const Coordinates& names,
                                                            const volume::EarthPlace& first) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<volume::EarthPlace> last,
                               PlacesAt(file, layout, names, layout.records - 1, 1));
  if (DomainOf(file) == 1 && IsSame(first, last.front())) return std::vector<volume::EarthPlace>();
  THUNDERHEAD_ASSIGN_OR_RETURN(std::vector<volume::EarthPlace> middles,
                               PlacesAt(file, layout, names, 0, layout.records));
  const auto missing = std::ranges::find_if_not(middles, IsPlace);
  if (missing != middles.end()) {
    return absl::DataLossError(
        absl::StrCat(file.Path(), ": ", names.latitude, " or ", names.longitude, " of record ",
                     missing - middles.begin(),
                     " has no value in the middle of the domain; write the file again"));
  }
  if (std::ranges::all_of(middles, [&](const auto& each) { return IsSame(first, each); })) {
    middles.clear();
  }
  return middles;
}

// Returns the middle by the attributes CEN_LAT and CEN_LON. Nests may move, and attributes of the
// whole domain are wrong for a part of it, so both give nothing.
std::optional<volume::EarthPlace> PlaceOfAttributes(const netcdf::NetcdfFile& file,
                                                    const WrfLayout& layout) {
  const auto number = [&](const char* name) { return file.NumberAttribute("", name); };
  const bool whole = number("WEST-EAST_GRID_DIMENSION") == layout.cells.x + 1.0 &&
                     number("SOUTH-NORTH_GRID_DIMENSION") == layout.cells.y + 1.0;
  const std::optional<double> latitude_deg = number("CEN_LAT");
  const std::optional<double> longitude_deg = number("CEN_LON");
  if (!whole || DomainOf(file) != 1 || !latitude_deg.has_value() || !longitude_deg.has_value()) {
    return std::nullopt;
  }
  return volume::EarthPlace{*latitude_deg, std::remainder(*longitude_deg, 360.0)};
}

void TakePlace(const netcdf::NetcdfFile& file, const volume::EarthPlace& middle, WrfPlace& place) {
  place.idealised = middle.latitude_deg == 0.0 && middle.longitude_deg == 0.0;
  if (place.idealised) return;
  place.middle = middle;
  place.projection = WrfProjectionOf(file);
}

}  // namespace

absl::StatusOr<WrfPlace> ReadWrfPlace(const netcdf::NetcdfFile& file, const WrfLayout& layout) {
  WrfPlace place;
  place.idealised = file.NumberAttribute("", "MAP_PROJ").value_or(1.0) == 0.0;
  if (place.idealised) return place;
  const auto unknown = [&](const std::string& why) {
    place.assumptions.push_back(absl::StrCat("The place on Earth is unknown, because ", why, "."));
    return place;
  };
  const std::optional<Coordinates> names = FindCoordinates(file, layout);
  if (!names.has_value()) {
    const std::optional<volume::EarthPlace> middle = PlaceOfAttributes(file, layout);
    if (middle.has_value()) {
      THUNDERHEAD_RETURN_IF_ERROR(
          CheckPlace(file, {"CEN_LAT", "CEN_LON"}, middle->latitude_deg, middle->longitude_deg));
    }
    if (!middle.has_value()) return unknown("the file has no XLAT and XLONG");
    TakePlace(file, *middle, place);
    if (place.idealised) return place;
    place.assumptions.push_back(
        "The place on Earth is that of the attributes CEN_LAT and CEN_LON, because the file has no "
        "XLAT and XLONG.");
    return place;
  }
  for (const auto& [name, unit] :
       {std::pair{names->latitude, kNorth}, std::pair{names->longitude, kEast}}) {
    if (!HasUnits(file, name, unit)) {
      spdlog::warn("the storm is shown without a place on Earth: {}",
                   std::string(CheckUnits(file, name, unit).message()));
      return unknown(absl::StrCat(name, " is not in degrees"));
    }
    THUNDERHEAD_RETURN_IF_ERROR(
        CheckVariable(file, layout, name, layout.Columns(), unit, Changes::kNever));
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<volume::EarthPlace> at_first,
                               PlacesAt(file, layout, *names, 0, 1));
  const volume::EarthPlace& first = at_first.front();
  if (!IsPlace(first)) {
    return unknown(absl::StrCat(names->latitude, " or ", names->longitude,
                                " has no value in the middle of the domain"));
  }
  TakePlace(file, first, place);
  if (place.idealised) return place;
  place.latitude = names->latitude;
  place.longitude = names->longitude;
  THUNDERHEAD_ASSIGN_OR_RETURN(place.middles, ReadMiddles(file, layout, *names, first));
  if (!place.middles.empty()) {
    place.assumptions.push_back(
        "The domain moves, and each time is shown at its own place, with its own distances and "
        "map projection.");
  }
  return place;
}

std::string WrfProjectionOf(const netcdf::NetcdfFile& file) {
  const auto number = [&](const char* name) { return file.NumberAttribute("", name); };
  const std::optional<double> first_deg = number("TRUELAT1");
  const std::optional<double> middle_deg = number("STAND_LON");
  if (!first_deg.has_value() || !middle_deg.has_value()) return "";
  constexpr char kSphere[] = " +x_0=0 +y_0=0 +R=6370000 +units=m +no_defs";
  switch (static_cast<int>(number("MAP_PROJ").value_or(0.0))) {
    case 1:
      return absl::StrFormat("+proj=lcc +lat_1=%.10g +lat_2=%.10g +lat_0=%.10g +lon_0=%.10g%s",
                             *first_deg, number("TRUELAT2").value_or(*first_deg),
                             number("MOAD_CEN_LAT").value_or(*first_deg), *middle_deg, kSphere);
    case 2:
      return absl::StrFormat("+proj=stere +lat_0=%d +lat_ts=%.10g +lon_0=%.10g%s",
                             *first_deg < 0.0 ? -90 : 90, *first_deg, *middle_deg, kSphere);
    case 3:
      return absl::StrFormat("+proj=merc +lat_ts=%.10g +lon_0=%.10g%s", *first_deg, *middle_deg,
                             kSphere);
    default:
      return "";
  }
}

int DomainOf(const netcdf::NetcdfFile& file) {
  return static_cast<int>(file.NumberAttribute("", "GRID_ID").value_or(1.0));
}

}  // namespace thunderhead::storm_files
