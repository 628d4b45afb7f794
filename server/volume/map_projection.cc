#include "volume/map_projection.h"

#include <proj.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <utility>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "base/status.h"
#include "glm/geometric.hpp"
#include "glm/gtc/constants.hpp"
#include "glm/trigonometric.hpp"

namespace thunderhead::volume {

struct ProjDeleter {
  void operator()(PJ_CONTEXT* context) const { proj_context_destroy(context); }
  void operator()(PJ* object) const { proj_destroy(object); }
};
using ProjContext = std::unique_ptr<PJ_CONTEXT, ProjDeleter>;
using ProjObject = std::unique_ptr<PJ, ProjDeleter>;

namespace {

// The latitude beyond which a Mercator map has no place.
constexpr double kMercatorEnds_deg = 89.9999;

// A file system for PROJ in which there is no file.
const PROJ_FILE_API& NoFiles() {
  static const PROJ_FILE_API files = {
      .version = 1,
      .open_cbk = [](PJ_CONTEXT*, const char*, PROJ_OPEN_ACCESS, void*) -> PROJ_FILE_HANDLE* {
        return nullptr;
      },
      .read_cbk = [](PJ_CONTEXT*, PROJ_FILE_HANDLE*, void*, std::size_t,
                     void*) { return std::size_t{0}; },
      .write_cbk = [](PJ_CONTEXT*, PROJ_FILE_HANDLE*, const void*, std::size_t,
                      void*) { return std::size_t{0}; },
      .seek_cbk = [](PJ_CONTEXT*, PROJ_FILE_HANDLE*, long long, int, void*) { return 0; },
      .tell_cbk = [](PJ_CONTEXT*, PROJ_FILE_HANDLE*, void*) { return 0ULL; },
      .close_cbk = [](PJ_CONTEXT*, PROJ_FILE_HANDLE*, void*) {},
      .exists_cbk = [](PJ_CONTEXT*, const char*, void*) { return 0; },
      .mkdir_cbk = [](PJ_CONTEXT*, const char*, void*) { return 0; },
      .unlink_cbk = [](PJ_CONTEXT*, const char*, void*) { return 0; },
      .rename_cbk = [](PJ_CONTEXT*, const char*, const char*, void*) { return 0; },
  };
  return files;
}

// Replaces a zone of UTM by its transverse Mercator projection, so that ProjectionText accepts it.
void ExpandUtm(std::vector<std::string>& words) {
  const auto kind = std::ranges::find(words, "+proj=utm");
  if (kind == words.end()) return;
  *kind = "+proj=tmerc +lat_0=0 +k_0=0.9996 +x_0=500000";
  const bool is_south = std::erase(words, "+south") > 0;
  words.push_back(is_south ? "+y_0=10000000" : "+y_0=0");
  for (std::string& word : words) {
    int zone = 0;
    if (!absl::StartsWith(word, "+zone=") || !absl::SimpleAtoi(word.substr(6), &zone)) continue;
    constexpr int kZoneWidth_deg = 6;
    constexpr int kFirstMeridian_deg = -177;  // of zone 1
    word = absl::StrCat("+lon_0=", kFirstMeridian_deg + kZoneWidth_deg * (zone - 1));
  }
}

// Returns a context without files and network, whose errors are returned instead of printed.
ProjContext NewContext() {
  ProjContext context(proj_context_create());
  THUNDERHEAD_CHECK(
      context != nullptr && proj_context_set_fileapi(context.get(), &NoFiles(), nullptr) != 0,
      "PROJ takes no file system");
  // PROJ reports that it has no database at every log level, so its messages are discarded here.
  proj_log_func(context.get(), nullptr, [](void*, int, const char*) {});
  proj_context_set_enable_network(context.get(), 0);
  return context;
}

std::string ReasonOf(PJ_CONTEXT* context) {
  return proj_context_errno_string(context, proj_context_errno(context));
}

}  // namespace

// PROJ's objects for one projection. A context and its objects may be used by one thread at a time.
class MapProjection::Proj {
 public:
  static absl::StatusOr<std::unique_ptr<Proj>> Open(const std::string& text) {
    auto opened = std::make_unique<Proj>();
    opened->text_ = text;
    opened->context_ = NewContext();
    opened->transform_.reset(proj_create(opened->context_.get(), text.c_str()));
    if (opened->transform_ != nullptr) return opened;
    return absl::InvalidArgumentError(absl::StrCat("PROJ does not accept the map projection '",
                                                   text, "': ", ReasonOf(opened->context_.get())));
  }

  std::optional<glm::dvec2> Forward(const EarthPlace& place) {
    const std::lock_guard lock(mutex_);
    const PJ_COORD to = proj_trans(
        transform_.get(), PJ_FWD,
        proj_coord(glm::radians(place.longitude_deg), glm::radians(place.latitude_deg), 0.0, 0.0));
    if (!std::isfinite(to.xy.x) || !std::isfinite(to.xy.y)) return std::nullopt;
    return glm::dvec2(to.xy.x, to.xy.y);
  }

  std::optional<EarthPlace> Inverse(const glm::dvec2& map_m) {
    const std::lock_guard lock(mutex_);
    const PJ_COORD to =
        proj_trans(transform_.get(), PJ_INV, proj_coord(map_m.x, map_m.y, 0.0, 0.0));
    if (!std::isfinite(to.lp.phi) || !std::isfinite(to.lp.lam)) return std::nullopt;
    // Rounding can give a pole a latitude slightly beyond 90 degrees, which is corrected here.
    constexpr double kRounding_deg = 1e-9;
    double latitude_deg = glm::degrees(to.lp.phi);
    if (std::abs(latitude_deg) < 90.0 + kRounding_deg) {
      latitude_deg = std::clamp(latitude_deg, -90.0, 90.0);
    }
    return EarthPlace{latitude_deg, std::remainder(glm::degrees(to.lp.lam), 360.0)};
  }

  std::string WellKnownText(PJ_WKT_TYPE type) {
    const std::lock_guard lock(mutex_);
    const ProjObject system = System();
    if (system == nullptr) return "";
    // PROJ owns the text.
    const char* const text = proj_as_wkt(context_.get(), system.get(), type, nullptr);
    return text == nullptr ? "" : text;
  }

  EarthFigure Figure() {
    const std::lock_guard lock(mutex_);
    const ProjObject system = System();
    const ProjObject ellipsoid(
        system == nullptr ? nullptr : proj_get_ellipsoid(context_.get(), system.get()));
    EarthFigure figure;
    if (ellipsoid != nullptr) {
      proj_ellipsoid_get_parameters(context_.get(), ellipsoid.get(), &figure.semi_major_m, nullptr,
                                    nullptr, &figure.inverse_flattening);
    }
    return figure;
  }

 private:
  // Returns the coordinate reference system of the projection, or null.
  ProjObject System() {
    return ProjObject(proj_create(context_.get(), absl::StrCat(text_, " +type=crs").c_str()));
  }

  std::mutex mutex_;
  std::string text_;
  ProjContext context_;
  ProjObject transform_;  // is destroyed before its context
};

MapProjection::MapProjection(ProjectionText text, std::unique_ptr<Proj> proj)
    : text_(std::move(text)), proj_(std::move(proj)) {}
MapProjection::MapProjection(MapProjection&&) noexcept = default;
MapProjection& MapProjection::operator=(MapProjection&&) noexcept = default;
MapProjection::~MapProjection() = default;

absl::StatusOr<MapProjection> MapProjection::Open(std::string_view proj) {
  THUNDERHEAD_ASSIGN_OR_RETURN(ProjectionText text, ProjectionText::Parse(proj));
  THUNDERHEAD_ASSIGN_OR_RETURN(std::unique_ptr<Proj> opened, Proj::Open(std::string(proj)));
  MapProjection map(std::move(text), std::move(opened));
  const std::string& kind = map.text_.Kind();
  if (kind == "eqc" || kind == "merc" || kind == "cea") {
    if (const double circle_m = map.FullCircle_m(); circle_m > 0.0) map.full_circle_m_ = circle_m;
  }
  return map;
}

absl::StatusOr<MapProjection> MapProjection::Of(std::string_view proj, const EarthPlace& middle) {
  THUNDERHEAD_ASSIGN_OR_RETURN(MapProjection map, Open(proj));
  const std::optional<glm::dvec2> middle_m = map.Project(middle);
  if (!middle_m.has_value()) {
    return absl::InvalidArgumentError(
        absl::StrCat("the middle of the domain, ", middle.latitude_deg, " N ", middle.longitude_deg,
                     " E, is not on the map '", std::string(proj), "'"));
  }
  map.origin_m_ = *middle_m;
  return map;
}

// Returns the distance on the map for 360 degrees of longitude, for a projection whose x is
// proportional to the longitude. With a rotated pole, x is proportional to the longitude in the
// rotated grid.
double MapProjection::FullCircle_m() const {
  if (text_.HasRotatedPole()) {
    return 2.0 * glm::pi<double>() * text_.Number("R").value_or(0.0) *
           std::cos(glm::radians(text_.Number("lat_ts").value_or(0.0))) /
           text_.Number("to_meter").value_or(1.0);
  }
  const double lon_0 = text_.Number("lon_0").value_or(0.0) + text_.Number("pm").value_or(0.0);
  const std::optional<glm::dvec2> from_m = Project({0.0, lon_0});
  const std::optional<glm::dvec2> to_m = Project({0.0, lon_0 + 90.0});
  return from_m.has_value() && to_m.has_value() ? 4.0 * (to_m->x - from_m->x) : 0.0;
}

std::optional<glm::dvec2> MapProjection::Project(const EarthPlace& place) const {
  if (!(std::abs(place.latitude_deg) <= 90.0) || !std::isfinite(place.longitude_deg)) {
    return std::nullopt;
  }
  const std::string& kind = text_.Kind();
  // PROJ returns numbers even for places that are not on these maps: the poles on a Mercator map,
  // and places that a geostationary satellite does not see.
  if (kind == "merc" && std::abs(place.latitude_deg) > kMercatorEnds_deg) return std::nullopt;
  const std::optional<glm::dvec2> map_m = proj_->Forward(place);
  if (kind != "geos" || !map_m.has_value()) return map_m;
  const std::optional<EarthPlace> seen = proj_->Inverse(*map_m);
  const bool is_seen =
      seen.has_value() && std::abs(seen->latitude_deg - place.latitude_deg) < 1e-6 &&
      std::abs(std::remainder(seen->longitude_deg - place.longitude_deg, 360.0)) < 1e-6;
  return is_seen ? map_m : std::nullopt;
}

std::optional<glm::dvec2> MapProjection::WorldOf(const EarthPlace& place) const {
  const std::optional<glm::dvec2> map_m = Project(place);
  if (!map_m.has_value()) return std::nullopt;
  glm::dvec2 world_m = *map_m - origin_m_;
  if (full_circle_m_.has_value()) world_m.x = std::remainder(world_m.x, *full_circle_m_);
  return world_m;
}

std::optional<EarthPlace> MapProjection::PlaceOf(const glm::dvec2& world_m) const {
  const glm::dvec2 map_m = origin_m_ + world_m;
  const std::optional<EarthPlace> place = proj_->Inverse(map_m);
  if (!place.has_value()) return std::nullopt;
  // Beyond the map's edge PROJ may return a place, but that place is elsewhere on the map.
  const std::optional<glm::dvec2> back_m = Project(*place);
  if (!back_m.has_value()) return std::nullopt;
  glm::dvec2 off_m = *back_m - map_m;
  if (full_circle_m_.has_value()) off_m.x = std::remainder(off_m.x, *full_circle_m_);
  const double tolerance_m = 0.01 + 1e-8 * glm::length(map_m);
  if (!(glm::length(off_m) < tolerance_m)) return std::nullopt;
  return place;
}

std::optional<double> MapProjection::TrueNorth_deg(const EarthPlace& place) const {
  // The meridian's direction on the map follows from two places a hundred metres apart.
  constexpr double kStep_deg = 1e-3;
  EarthPlace south = place;
  EarthPlace north = place;
  south.latitude_deg = std::max(place.latitude_deg - kStep_deg / 2.0, -90.0);
  north.latitude_deg = std::min(place.latitude_deg + kStep_deg / 2.0, 90.0);
  const std::optional<glm::dvec2> from_m = Project(south);
  const std::optional<glm::dvec2> to_m = Project(north);
  if (!from_m.has_value() || !to_m.has_value()) return std::nullopt;
  glm::dvec2 way_m = *to_m - *from_m;
  if (full_circle_m_.has_value()) way_m.x = std::remainder(way_m.x, *full_circle_m_);
  return glm::degrees(std::atan2(way_m.x, way_m.y));
}

EarthFigure MapProjection::Figure() const { return proj_->Figure(); }

std::string MapProjection::WellKnownText(WellKnown variant) const {
  return proj_->WellKnownText(variant == WellKnown::kGdal ? PJ_WKT1_GDAL : PJ_WKT2_2019);
}

absl::StatusOr<std::string> ProjectionOfWellKnownText(const std::string& text) {
  const auto refused = [](const std::string& problem) {
    return absl::InvalidArgumentError(
        absl::StrCat("the well-known text of the map projection cannot be used: ", problem));
  };
  const ProjContext context = NewContext();
  const ProjObject system(
      proj_create_from_wkt(context.get(), text.c_str(), nullptr, nullptr, nullptr));
  if (system == nullptr) return refused("PROJ cannot parse it");
  const char* const proj = proj_as_proj_string(context.get(), system.get(), PJ_PROJ_4, nullptr);
  if (proj == nullptr) return refused("PROJ has no other notation for it");
  // The words that are removed do not change where a place is on the map.
  std::vector<std::string> words = absl::StrSplit(proj, ' ', absl::SkipEmpty());
  std::erase_if(words, [](const std::string& word) {
    return word == "+type=crs" || absl::StartsWith(word, "+towgs84=");
  });
  for (std::string& word : words) {
    constexpr std::string_view kMeridian = "+pm=";
    if (!absl::StartsWith(word, std::string(kMeridian))) continue;
    const auto named = PrimeMeridianNamed(std::string_view(word).substr(kMeridian.size()));
    if (named.has_value()) word = absl::StrFormat("+pm=%.12g", *named);
  }
  ExpandUtm(words);
  std::string composed = absl::StrJoin(words, " ");
  THUNDERHEAD_RETURN_IF_ERROR(ProjectionText::Parse(composed).status());
  return composed;
}

std::optional<double> PrimeMeridianNamed(std::string_view name) {
  const std::string id = absl::AsciiStrToLower(absl::string_view(name.data(), name.size()));
  for (const PJ_PRIME_MERIDIANS* known = proj_list_prime_meridians(); known->id != nullptr;
       ++known) {
    if (id == known->id) return glm::degrees(proj_dmstor(known->defn, nullptr));
  }
  return std::nullopt;
}

std::optional<double> PrimeMeridianOfWellKnownText(const std::string& text) {
  const ProjContext context = NewContext();
  ProjObject system(proj_create_from_wkt(context.get(), text.c_str(), nullptr, nullptr, nullptr));
  if (system != nullptr && proj_get_type(system.get()) == PJ_TYPE_COMPOUND_CRS) {
    system.reset(proj_crs_get_sub_crs(context.get(), system.get(), 0));
  }
  if (system != nullptr && proj_get_type(system.get()) == PJ_TYPE_BOUND_CRS) {
    system.reset(proj_get_source_crs(context.get(), system.get()));
  }
  if (system == nullptr) return std::nullopt;
  const ProjObject meridian(proj_get_prime_meridian(context.get(), system.get()));
  double longitude = 0.0;
  double radians_per_unit = 0.0;
  if (meridian == nullptr ||
      proj_prime_meridian_get_parameters(context.get(), meridian.get(), &longitude,
                                         &radians_per_unit, nullptr) == 0) {
    return std::nullopt;
  }
  return glm::degrees(longitude * radians_per_unit);
}

}  // namespace thunderhead::volume
