#include "storm_files/grib_finder.h"

#include <algorithm>
#include <array>
#include <initializer_list>
#include <span>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "base/status.h"

namespace thunderhead::storm_files::grib_finder {

bool Finder::IsAtGround(const Candidate& candidate, GribKind kind) const {
  const grib::Field& field = candidate.Field();
  // IFS codes the surface pressure and geopotential as its hybrid level 1.
  const bool is_first_hybrid = field.first.type == kHybrid && field.first.value == 1.0 &&
                               (kind == GribKind::kLogPressure || kind == GribKind::kGeopotential);
  return candidate.meaning.kind == kind && (field.first.type == kGround || is_first_hybrid) &&
         IsSameGrid(field, *first_);
}

// Returns the first field of the kind at the ground.
const std::optional<GribPlace>& Finder::AtGroundAtAnyTime(GribKind kind) {
  const auto [at, is_new] = at_ground_at_any_time_.try_emplace(kind);
  if (is_new) {
    const auto found = std::ranges::find_if(
        candidates_, [&](const Candidate& candidate) { return IsAtGround(candidate, kind); });
    if (found != candidates_.end()) at->second = found->place;
  }
  return at->second;
}

absl::StatusOr<std::optional<GribPlace>> Finder::AtGround(GribKind kind, absl::Time time,
                                                          bool at_any_time) {
  for (const Candidate& candidate : At(time)) {
    if (IsAtGround(candidate, kind)) return candidate.place;
  }
  return at_any_time ? AtGroundAtAnyTime(kind) : std::nullopt;
}

absl::Status Finder::FindSurface(absl::Time time, GribLayers& layers) {
  const auto find = [&](std::initializer_list<GribKind> kinds, bool at_any_time,
                        GribSeries& series) -> absl::Status {
    for (const GribKind kind : kinds) {
      THUNDERHEAD_ASSIGN_OR_RETURN(const std::optional<GribPlace> place,
                                   AtGround(kind, time, at_any_time));
      if (!place.has_value()) continue;
      series.kind = kind;
      series.name = NameOf(*place->field);
      series.levels = {*place};
      return absl::OkStatus();
    }
    return absl::OkStatus();
  };
  THUNDERHEAD_RETURN_IF_ERROR(
      find({GribKind::kGeopotentialHeight, GribKind::kGeometricHeight, GribKind::kGeopotential},
           true, layers.surface_height));
  THUNDERHEAD_RETURN_IF_ERROR(
      find({GribKind::kPressure, GribKind::kLogPressure}, false, layers.surface_pressure));
  THUNDERHEAD_RETURN_IF_ERROR(find({GribKind::kLandUse}, true, layers.land_use));
  if (layers.land_use.Empty()) return absl::OkStatus();
  if (!HasModisClasses(*layers.land_use.levels[0].field)) {
    layers.land_use = {};
    return absl::OkStatus();
  }
  Assume(absl::StrCat(layers.land_use.name, " has classes of MODIS (IGBP)."));
  THUNDERHEAD_RETURN_IF_ERROR(find({GribKind::kLandShare}, true, layers.land_share));
  THUNDERHEAD_RETURN_IF_ERROR(find({GribKind::kSnowCover}, false, layers.snow_cover));
  THUNDERHEAD_RETURN_IF_ERROR(find({GribKind::kAlbedo}, false, layers.albedo));
  return find({GribKind::kGreenCover}, true, layers.green_cover);
}

absl::Status Finder::FindIsobaricHeights(absl::Time time, GribLayers& layers) {
  layers.vertical = GribVertical::kIsobaric;
  THUNDERHEAD_ASSIGN_OR_RETURN(const Found heights, LevelsOf(GribKind::kGeopotentialHeight, time));
  THUNDERHEAD_ASSIGN_OR_RETURN(const Found geopotential, LevelsOf(GribKind::kGeopotential, time));
  const Found& found = heights.levels.size() >= geopotential.levels.size() ? heights : geopotential;
  layers.heights = Series(found, layers.levels);
  std::vector<std::string> computed;
  for (std::size_t i = 0; i < layers.levels.size(); ++i) {
    if (layers.heights.levels[i].field == nullptr) {
      computed.push_back(LevelName(type_, layers.levels[i]));
    }
  }
  if (computed.size() == layers.levels.size()) {
    if (layers.surface_height.Empty() || layers.surface_pressure.Empty()) {
      return Refused(
          "has neither the height (0/3/5, 0/3/4) of its isobaric levels nor height and pressure of "
          "the ground; give a file with one of them");
    }
    layers.heights = {};
    Assume("Heights of levels are computed from pressure, temperature and humidity (hydrostatic).");
  } else if (!computed.empty()) {
    AssumeOfTime(
        absl::StrCat("Heights of these levels are computed from the next level's (hydrostatic): ",
                     absl::StrJoin(computed, ", "), "."));
  }
  if (layers.surface_pressure.Empty() && layers.surface_height.Empty()) {
    Assume(
        "Levels below the ground are not recognised, because the file has neither height nor "
        "pressure of the ground.");
  } else {
    Assume("Levels below the ground are left out.");
  }
  return absl::OkStatus();
}

absl::Status Finder::FindHalfHeights(GribLayers& layers) {
  const auto is_height = [this](const Candidate& candidate) {
    if (candidate.meaning.kind != GribKind::kGeometricHeight) return false;
    const auto& mine = candidate.Field().vertical;
    const auto& storms = first_->vertical;
    const bool both =
        mine != nullptr && storms != nullptr && mine->has_grid_id && storms->has_grid_id;
    return !both || mine->grid_id == storms->grid_id;
  };
  if (!half_heights_.has_value()) {
    THUNDERHEAD_ASSIGN_OR_RETURN(half_heights_, Levels(std::nullopt, true, is_height));
  }
  const Found& found = *half_heights_;
  if (found.levels.empty()) return absl::OkStatus();
  std::vector<double> half_levels = layers.levels;
  half_levels.push_back(layers.levels.back() + 1.0);
  // Some programs write one number for a level, so that its height cannot be told from that of a
  // half level.
  if (!has_layers_) {
    Assume(absl::StrCat("Each of the ", contents_.level_kind,
                        " has one number k, and is taken to lie between the half levels k and k + "
                        "1, whose heights are given."));
  }
  for (const double level : half_levels) {
    if (found.levels.contains(level)) continue;
    return Missing(absl::StrCat("the heights of half levels are incomplete: ", Described(found),
                                " of half level ", level),
                   layers.time);
  }
  if (found.levels.rbegin()->first > half_levels.back()) {
    return Missing(absl::StrCat("every field of ", LevelName(type_, half_levels.back())),
                   layers.time);
  }
  // The first of the levels is the highest. A file may have the lower levels only.
  if (found.levels.begin()->first < half_levels.front()) {
    AssumeOfTime(
        absl::StrCat("The storm ends at ", LevelName(type_, layers.levels.front()),
                     ", because no field is on the levels above, whose heights are given."));
  }
  layers.heights = Series(found, half_levels);
  layers.heights.on_half_levels = true;
  layers.vertical = GribVertical::kHalfHeights;
  return absl::OkStatus();
}

// Returns an error if the coefficients of hybrid levels (pv) have more levels than the fields. They
// are those of half levels, with the share of the surface pressure from 0 to 1.
absl::Status Finder::CheckLastLevel(const GribLayers& layers) const {
  if ((type_ != kHybrid && type_ != kHybridPressure) || first_->vertical == nullptr) {
    return absl::OkStatus();
  }
  const std::vector<float>& numbers = first_->vertical->numbers;
  const std::size_t half_levels = numbers.size() / 2;
  if (half_levels < 2 || numbers.size() % 2 != 0) return absl::OkStatus();
  const std::span shares = std::span(numbers).subspan(half_levels);
  const bool are_shares =
      std::ranges::all_of(shares, [](float share) { return share >= 0.0F && share <= 1.0F; }) &&
      std::max(shares.front(), shares.back()) == 1.0F;
  const double next = layers.levels.back() + 1.0;
  if (!are_shares || next >= static_cast<double>(half_levels)) return absl::OkStatus();
  return Missing(absl::StrCat("every field of ", LevelName(type_, next)), layers.time);
}

absl::Status Finder::FindHydrostatic(absl::Time time, GribLayers& layers) {
  const auto& vertical = first_->vertical;
  if (vertical == nullptr || vertical->numbers.empty() || type_ == kHybridHeight ||
      type_ == kGeneralized) {
    const std::string levels = LevelName(type_, layers.levels.front());
    if (type_ == kGeneralized) {
      return Refused(absl::StrCat(
          levels,
          " and the others have no heights; add the files with the heights of half levels "
          "(HHL, 0/3/6), which match the fields' uuidOfVGrid"));
    }
    return Refused(absl::StrCat(
        levels,
        " and the others have neither heights (0/3/5, 0/3/6) nor coefficients (pv) with "
        "surface pressure and geopotential; add one of them"));
  }
  const std::vector<float>& numbers = vertical->numbers;
  const std::size_t half_levels = numbers.size() / 2;
  if (numbers.size() % 2 != 0 || layers.levels.back() + 1.0 > static_cast<double>(half_levels) ||
      layers.levels.front() < 1.0) {
    return Refused(absl::StrCat("has ", numbers.size(),
                                " coefficients of hybrid levels (pv), which do not fit level ",
                                layers.levels.back()));
  }
  if (layers.levels.back() + 1.0 != static_cast<double>(half_levels)) {
    return Missing(absl::StrCat("every field of ", LevelName(type_, layers.levels.back() + 1.0)),
                   time);
  }
  if (layers.surface_pressure.Empty()) {
    return Missing("the surface pressure (0/3/25 or 0/3/0), which the heights of levels need,",
                   time);
  }
  if (layers.surface_height.Empty()) {
    return Missing("the ground's geopotential (0/3/4), which the heights of levels need,", time);
  }
  layers.half_level_coefficients = numbers;
  layers.vertical = GribVertical::kHydrostatic;
  Assume("Heights of levels are computed from pressure, temperature and humidity (hydrostatic).");
  return absl::OkStatus();
}

absl::Status Finder::FindHeights(absl::Time time, GribLayers& layers) {
  if (type_ == kIsobaricSurface) return FindIsobaricHeights(time, layers);
  if (has_layers_ || type_ == kGeneralized) {
    THUNDERHEAD_RETURN_IF_ERROR(FindHalfHeights(layers));
  }
  if (layers.heights.Empty()) {
    for (const GribKind kind :
         {GribKind::kGeometricHeight, GribKind::kGeopotentialHeight, GribKind::kGeopotential}) {
      THUNDERHEAD_ASSIGN_OR_RETURN(const Found found, LevelsOf(kind, time));
      // A geopotential on a single level is that of the ground, as IFS codes it.
      if (found.levels.size() < 2) continue;
      for (const double level : layers.levels) {
        if (found.levels.contains(level)) continue;
        return Missing(absl::StrCat(Described(found), " of ", LevelName(type_, level)), time);
      }
      layers.heights = Series(found, layers.levels);
      break;
    }
  }
  if (layers.heights.Empty()) return FindHydrostatic(time, layers);
  if (layers.vertical == GribVertical::kHeights) {
    THUNDERHEAD_RETURN_IF_ERROR(CheckLastLevel(layers));
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(const Found pressure, LevelsOf(GribKind::kPressure, time));
  if (pressure.levels.empty()) {
    return Missing(absl::StrCat(GribKindName(GribKind::kPressure), " of ",
                                LevelName(type_, layers.levels.front()), " and the others"),
                   time);
  }
  for (const double level : layers.levels) {
    if (pressure.levels.contains(level)) continue;
    return Missing(absl::StrCat(Described(pressure), " of ", LevelName(type_, level)), time);
  }
  layers.pressure = Series(pressure, layers.levels);
  return absl::OkStatus();
}

// Returns a field that a storm does not need. It is left out if a level is missing.
GribSeries Finder::Optional(const Found& found, const std::vector<double>& levels,
                            const GribLayers& layers) {
  for (const double level : levels) {
    if (found.levels.empty() || found.levels.contains(level)) continue;
    AssumeOfTime(absl::StrCat(Described(found), " is not used, because ", LevelName(type_, level),
                              " is missing at ", TimeText(layers.time), "."));
    return GribSeries();
  }
  return found.levels.empty() ? GribSeries() : Series(found, levels);
}

// Finds wind and turbulence, which a storm does not need. They are left out if a level is missing.
// ICON has the vertical wind and the turbulence on half levels.
absl::Status Finder::FindMotion(absl::Time time, GribLayers& layers) {
  std::vector<double> half_levels = layers.levels;
  half_levels.push_back(layers.levels.back() + 1.0);
  const auto find = [&](GribKind kind, bool on_half_levels, GribSeries& series) -> absl::Status {
    if (!series.Empty()) return absl::OkStatus();
    const std::vector<double>& levels = on_half_levels ? half_levels : layers.levels;
    THUNDERHEAD_ASSIGN_OR_RETURN(const Found found, LevelsOf(kind, time, on_half_levels));
    series = Optional(found, levels, layers);
    series.on_half_levels = on_half_levels;
    return absl::OkStatus();
  };
  THUNDERHEAD_RETURN_IF_ERROR(find(GribKind::kWindX, false, layers.wind_x));
  THUNDERHEAD_RETURN_IF_ERROR(find(GribKind::kWindY, false, layers.wind_y));
  THUNDERHEAD_RETURN_IF_ERROR(find(GribKind::kAscent, false, layers.ascent));
  THUNDERHEAD_RETURN_IF_ERROR(find(GribKind::kOmega, false, layers.ascent));
  THUNDERHEAD_RETURN_IF_ERROR(find(GribKind::kTurbulentEnergy, false, layers.energy));
  if (!has_layers_) return absl::OkStatus();
  THUNDERHEAD_RETURN_IF_ERROR(find(GribKind::kAscent, true, layers.ascent));
  return find(GribKind::kTurbulentEnergy, true, layers.energy);
}

}  // namespace thunderhead::storm_files::grib_finder
