#include "storm_files/even_columns.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/status.h"
#include "glm/common.hpp"
#include "glm/geometric.hpp"
#include "glm/gtc/constants.hpp"
#include "glm/trigonometric.hpp"
#include "storm_files/column_raster.h"
#include "storm_files/measured_domain.h"
#include "storm_files/model_columns.h"
#include "storm_files/true_scale.h"

namespace thunderhead::storm_files {
namespace {

using volume::EarthPlace;
using volume::MapProjection;

double Least(const glm::dvec2& each) { return std::min(each.x, each.y); }
double Largest(const glm::dvec2& each) { return std::max(each.x, each.y); }

// A map on which the columns of a wide domain can be.
struct WideMap {
  std::string projection;
  MapScale scale;

  double Error() const { return scale.Error(); }
};

// Returns a stereographic projection whose scale is true at `middle`.
std::string StereographicAt(const EarthPlace& middle, const std::string& earth) {
  return absl::StrFormat(
      "+proj=stere +lat_0=%.10g +lon_0=%.10g +k=1 +x_0=0 +y_0=0 %s +units=m +no_defs",
      middle.latitude_deg, middle.longitude_deg, earth);
}

class Evener {
 public:
  Evener(const ModelColumns& model, const EarthPlace& middle, MapProjection local)
      : model_(model),
        middle_(middle),
        local_(std::move(local)),
        earth_(local_.Figure()),
        domain_(model, earth_) {}

  absl::StatusOr<EvenColumns> Make(const EvenOptions& options);
  absl::StatusOr<std::string> Projection(const EvenOptions& options);

 private:
  absl::StatusOr<double> GridNorth_rad() const;
  glm::dvec2 StepOn(const MapProjection& map, int axis) const;
  std::string TrueAtMiddle(const std::string& projection) const;
  absl::Status Keep(const std::string& projection, EvenColumns& even) const;
  bool KeepIfEven(EvenColumns& even) const;
  std::vector<WideMap> ConformalMaps() const;
  absl::Status ChooseWideMap(bool may_stay, EvenColumns& even) const;
  absl::StatusOr<ColumnMesh> MeshOn(const MapProjection& map, const EvenColumns& even) const;
  void ChooseGrid(const ColumnMesh& mesh, const glm::dvec2& middle_m, const EvenOptions& options,
                  EvenColumns& even) const;
  absl::StatusOr<EvenColumns> Measured(const EvenOptions& options) const;
  absl::Status Resample(const EvenOptions& options, EvenColumns& even) const;

  const ModelColumns& model_;
  const EarthPlace middle_;
  const MapProjection local_;  // stereographic around the middle
  const volume::EarthFigure earth_;
  const MeasuredDomain domain_;
};

absl::StatusOr<double> Evener::GridNorth_rad() const {
  const double half = model_.IsProjected() ? 0.5 : 0.5 * (model_.Count().y - 1);
  const glm::dvec2 at = model_.MiddlePosition();
  const std::optional<EarthPlace> south = model_.PlaceAt(at - glm::dvec2(0.0, half));
  const std::optional<EarthPlace> north = model_.PlaceAt(at + glm::dvec2(0.0, half));
  if (!south.has_value() || !north.has_value()) return BeyondTheMap();
  const std::optional<glm::dvec2> from_m = local_.WorldOf(*south);
  const std::optional<glm::dvec2> to_m = local_.WorldOf(*north);
  if (!from_m.has_value() || !to_m.has_value()) return BeyondTheMap();
  const glm::dvec2 way_m = *to_m - *from_m;
  return std::atan2(-way_m.x, way_m.y);
}

// Returns the vector from column to column along an axis, in the middle of the domain and in the
// plane of `map`. It is NaN if the middle is not on the map.
glm::dvec2 Evener::StepOn(const MapProjection& map, int axis) const {
  glm::dvec2 half(0.0);
  half[axis] = 0.5;
  const std::optional<EarthPlace> from = model_.PlaceAt(model_.MiddlePosition() - half);
  const std::optional<EarthPlace> to = model_.PlaceAt(model_.MiddlePosition() + half);
  const auto plane_m = [&](const std::optional<EarthPlace>& place) {
    const std::optional<glm::dvec2> at_m = place.has_value() ? map.WorldOf(*place) : std::nullopt;
    return at_m.value_or(glm::dvec2(std::nan("")));
  };
  return plane_m(to) - plane_m(from);
}

// Returns a projection whose scale is true at the middle of the domain, and which otherwise equals
// that of the model.
std::string Evener::TrueAtMiddle(const std::string& projection) const {
  const ProjectionWords words(projection);
  const double y_deg =
      words.Number("lat_0").value_or(0.0) +
      glm::degrees(model_.PlaneAt(model_.MiddlePosition()).y / words.Number("R").value_or(1.0));
  std::string scaled = WithTrueScaleAt(projection, middle_, y_deg);
  if (scaled != projection || !IsConformal(words)) return scaled;
  // A projection without a latitude of true scale gets a scale factor.
  ProjectionWords unscaled = words;
  for (const char* const name : {"k", "k_0", "lat_ts"}) unscaled.Remove(name);
  const absl::StatusOr<MapProjection> map = MapProjection::Open(unscaled.Joined());
  if (!map.ok()) return projection;
  const double true_m = glm::length(StepOn(local_, 0));
  unscaled.Set("k_0", true_m / glm::length(StepOn(*map, 0)));
  return unscaled.Joined();
}

// Keeps the model's own columns if they are even in the plane of `projection`. Returns
// INVALID_ARGUMENT if even spacing would move a column near a corner by more than a quarter of the
// spacing and by more than 4 m.
absl::Status Evener::Keep(const std::string& projection, EvenColumns& even) const {
  THUNDERHEAD_ASSIGN_OR_RETURN(const MapProjection map, MapProjection::Of(projection, middle_));
  even.columns = model_.Count();
  if (model_.IsProjected()) {
    even.dx_m = StepOn(map, 0).x;
    even.dy_m = StepOn(map, 1).y;
  } else {
    even.dx_m = even.mean_m.x;
    even.dy_m = even.mean_m.y;
  }
  even.projection = projection;
  const glm::dvec2 spacing_m(even.dx_m, even.dy_m);
  even.least_scale = std::min(1.0, Least(spacing_m / even.longest_m));
  even.largest_scale = std::max(1.0, Largest(spacing_m / even.shortest_m));
  even.largest_error = std::max(even.largest_scale - 1.0, 1.0 - even.least_scale);
  // Places that the file gives for each column are accurate only to a few metres (kRounding_m). A
  // grid may end at a pole, so the compared places are a little within the corners (kNearEdge).
  constexpr double kRounding_m = 4.0;
  constexpr double kNearEdge = 0.98;
  const double most_m = std::max(kRounding_m, 0.25 * Least(spacing_m));
  const glm::dvec2 half = kNearEdge * model_.MiddlePosition();
  for (const glm::dvec2 side :
       {glm::dvec2(-1, -1), glm::dvec2(1, -1), glm::dvec2(-1, 1), glm::dvec2(1, 1)}) {
    const std::optional<EarthPlace> computed = map.PlaceOf(side * half * spacing_m);
    const std::optional<EarthPlace> actual = model_.PlaceAt(model_.MiddlePosition() + side * half);
    if (!computed.has_value() || !actual.has_value()) return BeyondTheMap();
    if (!(ShortDistance_m(*computed, *actual, earth_) <= most_m)) {
      return absl::InvalidArgumentError("the columns are not even on the map");
    }
  }
  return absl::OkStatus();
}

// Keeps the model's own columns if they are even in a projection whose lengths are true. Returns
// false if they are not.
bool Evener::KeepIfEven(EvenColumns& even) const {
  const auto keep = [&](const std::string& projection) {
    EvenColumns kept = even;
    if (!Keep(projection, kept).ok()) return false;
    const glm::dvec2 off = glm::abs(glm::dvec2(kept.dx_m, kept.dy_m) / kept.mean_m - 1.0);
    if (!(Largest(off) <= kEven) || kept.IsTooWide()) return false;
    even = std::move(kept);
    return true;
  };
  if (!model_.IsProjected()) return keep(StereographicAt(middle_, model_.Earth()));
  return keep(model_.Projection()) || keep(TrueAtMiddle(model_.Projection()));
}

// Returns conformal projections with north up and true scale at the middle, without those that have
// an edge within the domain.
std::vector<WideMap> Evener::ConformalMaps() const {
  double south_deg = middle_.latitude_deg;
  double north_deg = middle_.latitude_deg;
  const auto extend = [&](const EarthPlace& from, const EarthPlace& to, int /*span*/) {
    south_deg = std::min({south_deg, from.latitude_deg, to.latitude_deg});
    north_deg = std::max({north_deg, from.latitude_deg, to.latitude_deg});
  };
  if (!domain_.VisitSteps(1, extend).ok()) return {};
  const std::string rest = absl::StrFormat(" +lon_0=%.10g +x_0=0 +y_0=0 %s +units=m +no_defs",
                                           middle_.longitude_deg, model_.Earth());
  std::vector<std::string> projections = {StereographicAt(middle_, model_.Earth())};
  // A Lambert cone touches the Earth between the domain's south and north (Snyder 1987, Map
  // Projections, page 107). It is not used near a pole or the equator, where it is nearly a plane
  // or a cylinder.
  constexpr double kFarthest_deg = 80.0;
  constexpr double kNearest_deg = 5.0;
  constexpr double kShare = 1.0 / 6.0;
  const double touches_deg = 0.5 * (south_deg + north_deg);
  if (std::max(-south_deg, north_deg) < kFarthest_deg) {
    projections.push_back(absl::StrFormat("+proj=merc +lat_ts=%.10g", middle_.latitude_deg) + rest);
    if (std::abs(touches_deg) > kNearest_deg) {
      const std::string lambert =
          absl::StrFormat("+proj=lcc +lat_1=%.10g +lat_2=%.10g +lat_0=%.10g",
                          glm::mix(south_deg, north_deg, kShare),
                          glm::mix(north_deg, south_deg, kShare), middle_.latitude_deg);
      projections.push_back(WithTrueScaleAt(lambert + rest, middle_, 0.0));
    }
  }
  std::vector<WideMap> maps;
  for (std::string& projection : projections) {
    const absl::StatusOr<MapProjection> map = MapProjection::Open(projection);
    if (!map.ok()) continue;
    const absl::StatusOr<MapScale> scale = domain_.ScaleOf(*map);
    if (scale.ok()) maps.push_back({std::move(projection), *scale});
  }
  return maps;
}

// Chooses the map of a domain that is too wide for true distances on any flat map. The columns stay
// as they are if their own map is chosen and `may_stay`.
absl::Status Evener::ChooseWideMap(bool may_stay, EvenColumns& even) const {
  constexpr double kGoodMap = 0.2;
  const bool is_map = model_.IsProjected() && may_stay;
  EvenColumns kept = even;
  const absl::Status keeps = is_map ? Keep(TrueAtMiddle(model_.Projection()), kept)
                                    : absl::InvalidArgumentError("the columns have no map");
  const bool is_conformal = is_map && IsConformal(ProjectionWords(model_.Projection()));
  if (keeps.ok() && is_conformal && kept.largest_error <= kGoodMap) {
    even = std::move(kept);
    return absl::OkStatus();
  }
  const double quarter_m = glm::half_pi<double>() * MeanRadius_m(earth_);
  const std::vector<WideMap> maps =
      even.reach_m < quarter_m ? ConformalMaps() : std::vector<WideMap>();
  const auto best = std::ranges::min_element(maps, {}, &WideMap::Error);
  if (keeps.ok() && (best == maps.end() || (is_conformal && kept.largest_error <= best->Error()))) {
    even = std::move(kept);
    return absl::OkStatus();
  }
  if (best == maps.end()) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "the domain reaches %.0f km from its middle, and no flat map of it is of use; cut a region "
        "of at most %.0f km from its middle to its corners",
        even.reach_m / 1e3, quarter_m / 1e3));
  }
  even.projection = best->projection;
  even.least_scale = best->scale.least;
  even.largest_scale = best->scale.largest;
  even.largest_error = best->Error();
  return absl::OkStatus();
}

// Returns the positions of the model's columns on a map. Between columns of a projection that are
// about kExact_m apart, positions are interpolated, with an error of a few metres.
absl::StatusOr<ColumnMesh> Evener::MeshOn(const MapProjection& map, const EvenColumns& even) const {
  constexpr double kExact_m = 15e3;
  constexpr double kMostColumns = 8.0;
  const glm::ivec2& count = model_.Count();
  glm::ivec2 pieces = count + 1;
  if (model_.IsProjected()) {
    const glm::dvec2 stride = glm::clamp(kExact_m / even.mean_m, 1.0, kMostColumns);
    pieces = glm::ivec2(glm::ceil(glm::dvec2(count) / stride));
  }
  const auto position = [&](int i, int axis) {
    return model_.IsProjected() ? -0.5 + i * static_cast<double>(count[axis]) / pieces[axis]
                                : ColumnMesh::PositionOf(i, count[axis]);
  };
  std::vector<glm::dvec2> exact_m;
  for (int j = 0; j <= pieces.y; ++j) {
    for (int i = 0; i <= pieces.x; ++i) {
      const std::optional<EarthPlace> place = model_.PlaceAt({position(i, 0), position(j, 1)});
      const std::optional<glm::dvec2> plane_m =
          place.has_value() ? map.WorldOf(*place) : std::nullopt;
      if (!plane_m.has_value()) return BeyondTheMap();
      exact_m.push_back(*plane_m);
    }
  }
  if (!model_.IsProjected()) return ColumnMesh{count, std::move(exact_m)};
  ColumnMesh mesh{count, {}};
  mesh.plane_m.reserve(static_cast<std::size_t>(count.x + 2) *
                       static_cast<std::size_t>(count.y + 2));
  const auto width = static_cast<std::size_t>(pieces.x) + 1;
  for (int j = 0; j < count.y + 2; ++j) {
    for (int i = 0; i < count.x + 2; ++i) {
      const glm::dvec2 at =
          (glm::dvec2(ColumnMesh::PositionOf(i, count.x), ColumnMesh::PositionOf(j, count.y)) +
           0.5) *
          glm::dvec2(pieces) / glm::dvec2(count);
      const glm::ivec2 low = glm::clamp(glm::ivec2(at), glm::ivec2(0), pieces - 1);
      const glm::dvec2 share = at - glm::dvec2(low);
      const std::size_t k =
          static_cast<std::size_t>(low.y) * width + static_cast<std::size_t>(low.x);
      mesh.plane_m.push_back(glm::mix(glm::mix(exact_m[k], exact_m[k + 1], share.x),
                                      glm::mix(exact_m[k + width], exact_m[k + width + 1], share.x),
                                      share.y));
    }
  }
  return mesh;
}

// Chooses the number of even columns and their distances.
void Evener::ChooseGrid(const ColumnMesh& mesh, const glm::dvec2& middle_m,
                        const EvenOptions& options, EvenColumns& even) const {
  // The model's axes may point in any direction, for example near a pole. The spacing along each
  // even axis is therefore a mean of the model's two spacings. Each is weighted by the squared
  // cosine of the angle between the model's axis and the even axis.
  const double east = std::cos(even.grid_north_rad) * std::cos(even.grid_north_rad);
  glm::dvec2 spacing_m(east * even.mean_m.x + (1.0 - east) * even.mean_m.y,
                       east * even.mean_m.y + (1.0 - east) * even.mean_m.x);
  glm::dvec2 half_m(0.0);
  for (const glm::dvec2& at_m : mesh.plane_m) half_m = glm::max(half_m, glm::abs(at_m - middle_m));
  // A column of which less than a quarter is in the domain is left out.
  constexpr double kLeastShare = 0.25;
  if (options.columns.has_value()) {
    even.columns = *options.columns;
    spacing_m = glm::max(spacing_m, 2.0 * half_m / (glm::dvec2(even.columns) + 2.0 * kLeastShare));
    even.dx_m = spacing_m.x;
    even.dy_m = spacing_m.y;
    return;
  }
  const auto columns = [&] {
    return glm::max(glm::ceil(2.0 * half_m / spacing_m - 2.0 * kLeastShare), 1.0);
  };
  const double most = std::max(2.0 * model_.Count().x * model_.Count().y, 4.0);
  for (glm::dvec2 count = columns(); count.x * count.y > most; count = columns()) {
    constexpr double kLeastStep = 1.001;
    spacing_m *= std::max(std::sqrt(count.x * count.y / most), kLeastStep);
  }
  // The number of columns is made even or odd like that of the model. Around the middle of a domain
  // with north up, the columns then coincide with the model's, and interpolation smooths little
  // there.
  even.columns = glm::ivec2(columns());
  even.columns += (even.columns + model_.Count()) % 2;
  even.dx_m = spacing_m.x;
  even.dy_m = spacing_m.y;
}

// Resamples the columns to a grid in the projection of `even`.
absl::Status Evener::Resample(const EvenOptions& options, EvenColumns& even) const {
  // Each column needs about 100 bytes here.
  constexpr double kMostColumns = 1e8;
  const glm::ivec2& count = model_.Count();
  if (static_cast<double>(count.x) * count.y > kMostColumns) {
    return absl::ResourceExhaustedError(
        absl::StrCat("the grid has ", count.x, " x ", count.y,
                     " columns, which are too many to resample; cut a smaller region"));
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(const MapProjection map, MapProjection::Open(even.projection));
  const std::optional<glm::dvec2> middle_m = map.WorldOf(middle_);
  if (!middle_m.has_value()) return BeyondTheMap();
  THUNDERHEAD_ASSIGN_OR_RETURN(const ColumnMesh mesh, MeshOn(map, even));
  ChooseGrid(mesh, *middle_m, options, even);
  const glm::dvec2 spacing_m(even.dx_m, even.dy_m);
  const EvenGrid grid{even.columns, spacing_m,
                      *middle_m - 0.5 * glm::dvec2(even.columns - 1) * spacing_m};
  even.from = PlacesAmong(mesh, grid);
  if (even.from.empty()) {
    return absl::InvalidArgumentError(
        "the places of the columns do not form a grid; correct their latitudes and longitudes");
  }
  even.model_areas = AreasOf(mesh, even.dx_m * even.dy_m);
  return absl::OkStatus();
}

// Returns the columns without their places among the model's columns. If they must be resampled,
// their number and distances are not set either.
absl::StatusOr<EvenColumns> Evener::Measured(const EvenOptions& options) const {
  THUNDERHEAD_ASSIGN_OR_RETURN(const StepLengths x, domain_.StepsAlong(0, local_));
  THUNDERHEAD_ASSIGN_OR_RETURN(const StepLengths y, domain_.StepsAlong(1, local_));
  EvenColumns even;
  even.middle = middle_;
  even.model_columns = model_.Count();
  even.mean_m = {x.mean_m, y.mean_m};
  even.shortest_m = {x.shortest_m, y.shortest_m};
  even.longest_m = {x.longest_m, y.longest_m};
  THUNDERHEAD_ASSIGN_OR_RETURN(even.grid_north_rad, GridNorth_rad());
  // Columns without a projection must also be at right angles, with north up.
  const bool upright = model_.IsProjected() || std::max(x.largest_turn, y.largest_turn) <= kEven;
  const bool may_stay = options.columns.value_or(model_.Count()) == model_.Count();
  if (x.AreEven() && y.AreEven() && upright && may_stay && KeepIfEven(even)) return even;
  THUNDERHEAD_ASSIGN_OR_RETURN(even.reach_m, domain_.Reach_m(middle_));
  // The scale of a stereographic projection at an angle c from its centre is 1 / cos(c / 2)^2.
  const double cosine = std::cos(0.5 * even.reach_m / MeanRadius_m(earth_));
  even.largest_scale = 1.0 / (cosine * cosine);
  even.largest_error = even.largest_scale - 1.0;
  if (even.IsTooWide()) {
    THUNDERHEAD_RETURN_IF_ERROR(ChooseWideMap(may_stay, even));
  } else {
    even.projection = StereographicAt(middle_, model_.Earth());
  }
  return even;
}

absl::StatusOr<std::string> Evener::Projection(const EvenOptions& options) {
  THUNDERHEAD_ASSIGN_OR_RETURN(EvenColumns even, Measured(options));
  return std::move(even.projection);
}

absl::StatusOr<EvenColumns> Evener::Make(const EvenOptions& options) {
  THUNDERHEAD_ASSIGN_OR_RETURN(EvenColumns even, Measured(options));
  if (even.columns == glm::ivec2(0)) THUNDERHEAD_RETURN_IF_ERROR(Resample(options, even));
  return even;
}

// Creates an Evener for the columns, calls its function `make` and returns the result.
template <typename Made>
absl::StatusOr<Made> WithEvener(const ColumnPlaces& places,
                                absl::StatusOr<Made> (Evener::*make)(const EvenOptions&),
                                const EvenOptions& options) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const ModelColumns model, ModelColumns::Of(places));
  const std::optional<EarthPlace> middle = model.Middle();
  if (!middle.has_value()) return BeyondTheMap();
  THUNDERHEAD_ASSIGN_OR_RETURN(MapProjection local,
                               MapProjection::Open(StereographicAt(*middle, model.Earth())));
  return (Evener(model, *middle, std::move(local)).*make)(options);
}

// Returns "The columns were resampled to even distances of ...".
std::string ResampledSentence(const EvenColumns& even) {
  const std::string dx = absl::StrFormat("%.0f m", even.dx_m);
  const std::string dy = absl::StrFormat("%.0f m", even.dy_m);
  const auto range = [&](int axis) {
    return absl::StrFormat("%.0f to %.0f m", even.shortest_m[axis], even.longest_m[axis]);
  };
  const std::string ranges = range(0) == range(1)
                                 ? range(0)
                                 : absl::StrCat(range(0), " along x and ", range(1), " along y");
  return absl::StrCat("The columns were resampled to even distances of ",
                      dx == dy ? dx : absl::StrCat(dx, " by ", dy),
                      ", because the true distances between the model's columns are ", ranges, ".");
}

// Returns a scale in percent, rounded to a tenth away from 100, so that errors are never
// understated. Differences below a thousandth of a percent are ignored.
std::string PercentText(double scale) {
  constexpr double kBeyondUse = 10.0;
  constexpr double kUnsaid = 0.01;
  if (!(scale <= kBeyondUse)) return "more than 1000 %";
  const double tenths = 1000.0 * scale;
  const double rounded = scale < 1.0 ? std::floor(tenths + kUnsaid) : std::ceil(tenths - kUnsaid);
  return absl::StrFormat("%.1f %%", 0.1 * rounded);
}

}  // namespace

absl::StatusOr<EvenColumns> MakeEven(const ColumnPlaces& places, const EvenOptions& options) {
  return WithEvener(places, &Evener::Make, options);
}

absl::StatusOr<std::string> ProjectionOfEven(const ColumnPlaces& places,
                                             const EvenOptions& options) {
  return WithEvener(places, &Evener::Projection, options);
}

std::vector<std::string> AssumptionsOf(const EvenColumns& even) {
  std::vector<std::string> sentences;
  if (even.unstructured) {
    sentences.push_back(absl::StrFormat(
        "The %d cells of the unstructured grid were put on %d x %d even columns of %.0f m. Each "
        "column has the values of the nearest cell.",
        even.model_columns.x, even.columns.x, even.columns.y, even.dx_m));
  } else if (even.Resampled()) {
    sentences.push_back(ResampledSentence(even));
  }
  if (even.IsTooWide()) {
    sentences.push_back(absl::StrFormat(
        "The domain reaches %.0f km from its middle, and no flat map of it has true distances "
        "everywhere: distances on the map are true in the middle, and %s to %s of the true ones "
        "elsewhere.",
        even.reach_m / 1e3, PercentText(even.least_scale), PercentText(even.largest_scale)));
  }
  return sentences;
}

}  // namespace thunderhead::storm_files
