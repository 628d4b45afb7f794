#include "product/map_place.h"

#include <cstdlib>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"

namespace thunderhead::product {

absl::StatusOr<MapProjection> MapProjection::Open(const std::string& text) {
  MapProjection projection;
  projection.context_.reset(proj_context_create());
  // PROJ must print nothing, because its errors are returned in the status.
  proj_log_level(projection.context_.get(), PJ_LOG_NONE);
  projection.transform_.reset(proj_create(projection.context_.get(), text.c_str()));
  projection.system_.reset(
      proj_create(projection.context_.get(), absl::StrCat(text, " +type=crs").c_str()));
  if (projection.transform_ == nullptr || projection.system_ == nullptr) {
    const int code = proj_context_errno(projection.context_.get());
    return absl::InvalidArgumentError(
        absl::StrCat("PROJ does not know the map projection '", text, "' (",
                     proj_context_errno_string(projection.context_.get(), code), ")"));
  }
  for (const auto part : absl::StrSplit(text, ' ', absl::SkipEmpty())) {
    const std::pair<std::string, std::string> entry =
        absl::StrSplit(absl::StripPrefix(part, "+"), absl::MaxSplits('=', 1));
    projection.parameters_.insert(entry);
  }
  return projection;
}

glm::dvec2 MapProjection::PlaneOf_m(const Place& place) const {
  const PJ_COORD plane = proj_trans(
      transform_.get(), PJ_FWD,
      proj_coord(proj_torad(place.longitude_deg), proj_torad(place.latitude_deg), 0.0, 0.0));
  return {plane.xy.x, plane.xy.y};
}

Place MapProjection::PlaceOf(const glm::dvec2& plane_m) const {
  const PJ_COORD place =
      proj_trans(transform_.get(), PJ_INV, proj_coord(plane_m.x, plane_m.y, 0.0, 0.0));
  return {proj_todeg(place.lp.phi), proj_todeg(place.lp.lam)};
}

std::string MapProjection::WellKnownText(PJ_WKT_TYPE type) const {
  // PROJ owns the text.
  const char* const text = proj_as_wkt(context_.get(), system_.get(), type, nullptr);
  return text == nullptr ? "" : text;
}

std::string MapProjection::GdalText() const { return WellKnownText(PJ_WKT1_GDAL); }
std::string MapProjection::IsoText() const { return WellKnownText(PJ_WKT2_2019); }

std::string MapProjection::Text(const std::string& parameter) const {
  const auto found = parameters_.find(parameter);
  return found == parameters_.end() ? "" : found->second;
}

double MapProjection::Number(const std::string& parameter) const {
  double number = 0.0;
  (void)absl::SimpleAtod(Text(parameter), &number);
  return number;
}

std::string WorldFile(const MapPlace& place) {
  const glm::dvec2 first_m = place.MiddleOf_m(0, 0);
  return absl::StrFormat("%.10f\n0.0000000000\n0.0000000000\n%.10f\n%.10f\n%.10f\n",
                         place.pixel_m.x, -place.pixel_m.y, first_m.x, first_m.y);
}

}  // namespace thunderhead::product
