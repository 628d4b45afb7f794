#include "storm_files/even_columns.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/status.h"
#include "glm/common.hpp"
#include "glm/geometric.hpp"
#include "glm/trigonometric.hpp"
#include "storm_files/column_raster.h"
#include "storm_files/model_columns.h"
#include "storm_files/true_scale.h"

namespace thunderhead::storm_files {
namespace {

using volume::EarthPlace;
using volume::MapProjection;

// The largest difference from the mean distance, as a share of it, for which columns are even.
constexpr double kEven = 0.005;
// The number of places along each axis at which distances are measured.
constexpr int kSamples = 65;
// A latitude or longitude that is stored as a float is known to a metre. Distances between such
// places are measured over this length.
constexpr double kMeasured_m = 4000.0;

absl::Status BeyondTheMap() {
  return absl::InvalidArgumentError(
      "columns lie beyond the edge of their map projection; correct its parameters");
}

// Returns up to kSamples numbers from `first` to `last`. They are integers if `whole`.
std::vector<double> Spread(double first, double last, int most, bool whole) {
  const int count = std::clamp(most, 1, kSamples);
  std::vector<double> numbers;
  for (int i = 0; i < count; ++i) {
    const double at = count == 1 ? 0.5 * (first + last) : first + (last - first) * i / (count - 1);
    numbers.push_back(whole ? std::round(at) : at);
  }
  return numbers;
}

// Distances between neighbouring columns along one axis.
struct Distances {
  double shortest_m = std::numeric_limits<double>::infinity();
  double longest_m = 0.0;
  double mean_m = 0.0;
  double largest_turn = 0.0;  // the largest deviation of the axis from its compass direction, in
                              // radians

  bool AreEven() const {
    return shortest_m >= (1.0 - kEven) * mean_m && longest_m <= (1.0 + kEven) * mean_m;
  }
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
      : model_(model), middle_(middle), local_(std::move(local)) {
    const volume::EarthFigure figure = local_.Figure();
    const double flattening =
        figure.inverse_flattening > 0.0 ? 1.0 / figure.inverse_flattening : 0.0;
    earth_m_ = figure.semi_major_m * (1.0 - flattening / 3.0);
  }

  absl::StatusOr<EvenColumns> Make(const EvenOptions& options);
  absl::StatusOr<std::string> Projection(const EvenOptions& options);

 private:
  double Distance_m(const EarthPlace& a, const EarthPlace& b) const {
    return GreatCircle_m(a, b, earth_m_);
  }
  absl::StatusOr<Distances> Measure(int axis) const;
  int Span(int axis) const;
  absl::StatusOr<double> GridNorth_rad() const;
  std::optional<std::string> EvenProjection(const EvenColumns& even) const;
  bool Fits(const std::string& projection, const EvenColumns& even) const;
  absl::StatusOr<double> Reach_m() const;
  absl::StatusOr<ColumnMesh> MeshOn(const MapProjection& map, const EvenColumns& even) const;
  void ChooseGrid(const ColumnMesh& mesh, const glm::dvec2& middle_m, const EvenOptions& options,
                  EvenColumns& even) const;
  absl::StatusOr<EvenColumns> Measured(const EvenOptions& options) const;
  absl::Status ChooseMap(const EvenOptions& options, EvenColumns& even) const;
  absl::Status Resample(const EvenOptions& options, EvenColumns& even) const;

  const ModelColumns& model_;
  const EarthPlace middle_;
  const MapProjection local_;  // stereographic around the middle
  double earth_m_ = 0.0;       // mean radius of the Earth
};

// Returns the number of columns over which the distance between neighbours is measured.
int Evener::Span(int axis) const {
  if (model_.IsProjected()) return 1;
  const glm::dvec2 at = glm::floor(model_.MiddlePosition());
  glm::dvec2 next = at;
  next[axis] += 1.0;
  const double step_m = Distance_m(*model_.PlaceAt(at), *model_.PlaceAt(next));
  const double span = std::ceil(kMeasured_m / std::max(step_m, 1.0));
  return static_cast<int>(std::clamp(span, 1.0, model_.Count()[axis] - 1.0));
}

absl::StatusOr<Distances> Evener::Measure(int axis) const {
  const int span = Span(axis);
  const int other = 1 - axis;
  const bool whole = !model_.IsProjected();
  const glm::ivec2& count = model_.Count();
  const double first = whole ? 0.0 : -0.5;
  Distances distances;
  double sum_m = 0.0;
  int samples = 0;
  for (const double across : Spread(0.0, count[other] - 1.0, count[other], whole)) {
    for (const double along :
         Spread(first, first + count[axis] - (whole ? 1.0 + span : 1.0), count[axis], whole)) {
      glm::dvec2 from;
      from[axis] = along;
      from[other] = across;
      glm::dvec2 to = from;
      to[axis] += span;
      const std::optional<EarthPlace> a = model_.PlaceAt(from);
      const std::optional<EarthPlace> b = model_.PlaceAt(to);
      if (!a.has_value() || !b.has_value()) return BeyondTheMap();
      const double distance_m = Distance_m(*a, *b) / span;
      if (!std::isfinite(distance_m)) return BeyondTheMap();
      distances.shortest_m = std::min(distances.shortest_m, distance_m);
      distances.longest_m = std::max(distances.longest_m, distance_m);
      sum_m += distance_m;
      ++samples;
      const std::optional<glm::dvec2> from_m = local_.WorldOf(*a);
      const std::optional<glm::dvec2> to_m = local_.WorldOf(*b);
      if (!from_m.has_value() || !to_m.has_value()) continue;
      const glm::dvec2 way_m = *to_m - *from_m;
      const double turn = axis == 0 ? std::atan2(way_m.y, way_m.x) : std::atan2(-way_m.x, way_m.y);
      distances.largest_turn = std::max(distances.largest_turn, std::abs(turn));
    }
  }
  distances.mean_m = sum_m / samples;
  if (distances.mean_m > 0.0) return distances;
  return absl::InvalidArgumentError(
      absl::StrCat("all columns along ", axis == 0 ? "x" : "y",
                   " are at the same place; correct their latitudes and longitudes"));
}

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

// Returns whether the model's columns are at multiples of the distances in the plane of
// `projection`. They are compared at the corners of the domain.
bool Evener::Fits(const std::string& projection, const EvenColumns& even) const {
  const absl::StatusOr<MapProjection> map = MapProjection::Open(projection);
  if (!map.ok()) return false;
  const std::optional<glm::dvec2> middle_m = map->WorldOf(middle_);
  if (!middle_m.has_value()) return false;
  const glm::dvec2 half = 0.5 * glm::dvec2(model_.Count());
  for (const glm::dvec2 side :
       {glm::dvec2(-1, -1), glm::dvec2(1, -1), glm::dvec2(-1, 1), glm::dvec2(1, 1)}) {
    const glm::dvec2 offset_m = side * half * glm::dvec2(even.dx_m, even.dy_m);
    const std::optional<EarthPlace> computed = map->PlaceOf(*middle_m + offset_m);
    const std::optional<EarthPlace> actual = model_.PlaceAt(model_.MiddlePosition() + side * half);
    if (!computed.has_value() || !actual.has_value()) return false;
    const double off_m = Distance_m(*computed, *actual);
    if (!(off_m <= kEven * glm::length(offset_m))) return false;
  }
  return true;
}

// Returns the projection in which the model's own columns are even, or nothing if they are not.
std::optional<std::string> Evener::EvenProjection(const EvenColumns& even) const {
  if (!model_.IsProjected()) {
    std::string projection = StereographicAt(middle_, model_.Earth());
    return Fits(projection, even) ? std::optional(std::move(projection)) : std::nullopt;
  }
  if (Fits(model_.Projection(), even)) return model_.Projection();
  const ProjectionWords words(model_.Projection());
  const double y_deg =
      words.Number("lat_0").value_or(0.0) +
      glm::degrees(model_.PlaneAt(model_.MiddlePosition()).y / words.Number("R").value_or(1.0));
  std::string scaled = WithTrueScaleAt(model_.Projection(), middle_, y_deg);
  return Fits(scaled, even) ? std::optional(std::move(scaled)) : std::nullopt;
}

// Returns the distance of the middle from the farthest edge of the domain.
absl::StatusOr<double> Evener::Reach_m() const {
  double reach_m = 0.0;
  for (const double x : Spread(-0.5, model_.Count().x - 0.5, model_.Count().x + 1, false)) {
    for (const double y : Spread(-0.5, model_.Count().y - 0.5, model_.Count().y + 1, false)) {
      const std::optional<EarthPlace> place = model_.PlaceAt({x, y});
      if (!place.has_value()) return BeyondTheMap();
      reach_m = std::max(reach_m, Distance_m(middle_, *place));
    }
  }
  return reach_m;
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
  // A model's axis may point anywhere, for example near a pole.
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
  even.columns = glm::ivec2(columns());
  even.dx_m = spacing_m.x;
  even.dy_m = spacing_m.y;
}

// Sets the projection of resampled columns and its error.
absl::Status Evener::ChooseMap(const EvenOptions& options, EvenColumns& even) const {
  THUNDERHEAD_ASSIGN_OR_RETURN(const double reach_m, Reach_m());
  // The scale of a stereographic projection at an angle c from its centre is 1 / cos(c / 2)^2.
  const double cosine = std::cos(0.5 * reach_m / earth_m_);
  even.largest_error = 1.0 / (cosine * cosine) - 1.0;
  if (!(even.largest_error <= options.largest_error)) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "the domain reaches %.0f km from its middle, so distances on a flat grid would be wrong by "
        "up to %.1f %%; cut a region of at most %.0f km from its middle to its corners",
        reach_m / 1e3, 100.0 * even.largest_error,
        2e-3 * earth_m_ * std::acos(1.0 / std::sqrt(1.0 + options.largest_error))));
  }
  even.projection = StereographicAt(middle_, model_.Earth());
  return absl::OkStatus();
}

absl::Status Evener::Resample(const EvenOptions& options, EvenColumns& even) const {
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
  THUNDERHEAD_ASSIGN_OR_RETURN(const Distances x, Measure(0));
  THUNDERHEAD_ASSIGN_OR_RETURN(const Distances y, Measure(1));
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
  if (x.AreEven() && y.AreEven() && upright && may_stay) {
    even.dx_m = x.mean_m;
    even.dy_m = y.mean_m;
    const auto error = [](const Distances& each) {
      return std::max(each.longest_m / each.mean_m - 1.0, 1.0 - each.shortest_m / each.mean_m);
    };
    even.largest_error = std::max(error(x), error(y));
    if (std::optional<std::string> projection = EvenProjection(even); projection.has_value()) {
      even.columns = model_.Count();
      even.projection = *std::move(projection);
      return even;
    }
  }
  THUNDERHEAD_RETURN_IF_ERROR(ChooseMap(options, even));
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

// Returns what `make` returns for the columns.
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

}  // namespace

absl::StatusOr<EvenColumns> MakeEven(const ColumnPlaces& places, const EvenOptions& options) {
  return WithEvener(places, &Evener::Make, options);
}

absl::StatusOr<std::string> ProjectionOfEven(const ColumnPlaces& places,
                                             const EvenOptions& options) {
  return WithEvener(places, &Evener::Projection, options);
}

std::string AssumptionOf(const EvenColumns& even) {
  if (!even.Resampled()) return "";
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

}  // namespace thunderhead::storm_files
