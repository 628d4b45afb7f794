#include "storm_files/grib_layers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/status.h"
#include "storm_files/grib_finder.h"
#include "storm_files/grib_parts.h"
#include "storm_files/storm_file.h"

namespace thunderhead::storm_files {
namespace grib_finder {
namespace {

using physics::Hydrometeor;

// The types of levels that a storm may have. If two have equally many levels, the first is used.
constexpr std::array kLevelTypes = {kHybrid, kGeneralized, kHybridHeight, kHybridPressure,
                                    kIsobaricSurface};

// Returns whether a storm may have levels of this type.
bool IsLevelType(int type) { return std::ranges::find(kLevelTypes, type) != kLevelTypes.end(); }

// Splits cloud water that holds liquid and ice into two hydrometeors.
void SplitCloud(GribLayers& layers) {
  GribHydrometeor ice = layers.hydrometeors.front();
  layers.hydrometeors.front().is_split = true;
  ice.hydrometeor = Hydrometeor::kIce;
  ice.is_split = true;
  layers.hydrometeors.push_back(std::move(ice));
}

}  // namespace

std::string LevelKind(int type) {
  switch (type) {
    case kIsobaricSurface:
      return "isobaric levels";
    case kHybrid:
      return "hybrid levels";
    case kGeneralized:
      return "generalized levels";
    case kHybridHeight:
      return "hybrid height levels";
    case kHybridPressure:
      return "hybrid pressure levels";
    default:
      return "levels";
  }
}

std::string LevelName(int type, double value) {
  if (type == kIsobaricSurface) return absl::StrFormat("%.6g hPa", value / 100.0);
  std::string kind = LevelKind(type);
  kind.pop_back();
  return absl::StrFormat("%s %.6g", kind, value);
}

bool IsHeight(GribKind kind) {
  return kind == GribKind::kGeometricHeight || kind == GribKind::kGeopotential ||
         kind == GribKind::kGeopotentialHeight;
}

bool IsBetweenPressures(const grib::Field& field) {
  return field.first.type == kIsobaricSurface && field.second.type == kIsobaricSurface;
}

std::string TimeText(absl::Time time) {
  return absl::FormatTime("%Y-%m-%d %H:%M UTC", time, absl::UTCTimeZone());
}

// Returns the files' path, with the run and member if there are several.
std::string Finder::Where() const {
  if (all_.size() < 2) return contents_.path;
  const std::string member = GribMemberOf(wanted_->member);
  return absl::StrCat(contents_.path, " (run ", TimeText(wanted_->origin.reference),
                      member.empty() ? "" : ", ", member, ")");
}

// Chooses the type of levels on which hydrometeors have the most levels. A file on isobaric levels
// can also have its hydrometeors on one hybrid level, which does not count.
absl::Status Finder::ChooseLevels() {
  std::map<int, std::set<double>> levels;
  bool has_amounts = false;
  for (const Candidate& candidate : candidates_) {
    if (candidate.meaning.kind != GribKind::kAmount) continue;
    has_amounts = true;
    const grib::Surface& surface = candidate.Field().first;
    if (std::isfinite(surface.value) && !IsBetweenPressures(candidate.Field())) {
      levels[surface.type].insert(surface.value);
    }
  }
  if (!has_amounts) {
    return Refused(
        "has no field of cloud water (0/1/22, 0/1/83), cloud ice (0/1/23, 0/1/82, 0/1/84), rain "
        "(0/1/24, 0/1/85), snow (0/1/25, 0/1/86), graupel (0/1/32) or hail (0/1/71); give a file "
        "with at least one");
  }
  std::size_t most = 0;
  for (const int type : kLevelTypes) {
    if (levels[type].size() <= most) continue;
    most = levels[type].size();
    type_ = type;
  }
  if (most < 2) {
    return Refused(
        "has hydrometeors on fewer than two levels; it needs hybrid (105, 118, 119), generalized "
        "(150) or isobaric (100) levels");
  }
  for (const Candidate& candidate : candidates_) {
    const grib::Field& field = candidate.Field();
    if (candidate.meaning.kind != GribKind::kAmount || field.first.type != type_) continue;
    if (first_ == nullptr && !IsBetweenPressures(field)) first_ = &field;
  }
  has_layers_ = first_->second.type == type_;
  return absl::OkStatus();
}

absl::Status Finder::CheckOneRun() {
  for (const Candidate& candidate : candidates_) {
    const grib::Field& field = candidate.Field();
    if (field.first.type != type_) continue;
    // Heights that do not change may come from an earlier run.
    const bool may_differ = candidate.meaning.kind == GribKind::kGeometricHeight;
    if (!may_differ && field.origin != first_->origin) {
      return Refused(absl::StrCat(
          "has fields of several runs (", TimeText(first_->origin.reference), " of centre ",
          first_->origin.centre, ", and ", TimeText(field.origin.reference), " of centre ",
          field.origin.centre, "); put each run into a separate file or folder"));
    }
    if (candidate.meaning.kind != GribKind::kAmount) continue;
    if (!IsSameGrid(field, *first_)) {
      return Refused("has hydrometeors on several grids; put each grid into a separate file");
    }
  }
  contents_.origin = first_->origin;
  contents_.process = first_->process;
  contents_.member = GribMemberOf(first_->member);
  contents_.level_kind = LevelKind(type_);
  contents_.model = ModelOf(*first_);
  auto grid = grib::ReadGrid(*first_->grid);
  if (!grid.ok()) return base::Annotate(grid.status(), Where());
  contents_.grid = *std::move(grid);
  for (const std::string& assumption : contents_.grid.assumptions) Assume(assumption);
  const grib::Grid& read = contents_.grid;
  return read.IsUnstructured() && read.cell_rows.empty() ? FindCells() : absl::OkStatus();
}

// Finds the places of the cells, which are fields on the same grid.
absl::Status Finder::FindCells() {
  for (const Candidate& candidate : candidates_) {
    if (!IsSameGrid(candidate.Field(), *first_)) continue;
    if (candidate.meaning.kind == GribKind::kCellLatitude) {
      contents_.cell_latitude = candidate.place;
    } else if (candidate.meaning.kind == GribKind::kCellLongitude) {
      contents_.cell_longitude = candidate.place;
    }
  }
  if (contents_.cell_latitude.field != nullptr && contents_.cell_longitude.field != nullptr) {
    return absl::OkStatus();
  }
  return Refused(absl::StrCat(
      "lies on the cells of ICON's unstructured ", contents_.grid.cells,
      ", whose places are missing; add the files with the latitudes and longitudes of this grid's "
      "cells (CLAT, 0/191/1, and CLON, 0/191/2)"));
}

// Returns whether the field is on a level of the storm's type, or on a half level between them.
bool Finder::IsOnLevel(const grib::Field& field, bool on_half_level) const {
  if (field.first.type != type_ || !std::isfinite(field.first.value)) return false;
  if (!IsSameGrid(field, *first_)) return false;
  if (field.member != first_->member && field.member.has_value()) return false;
  const bool is_layer = field.second.type == type_;
  if (type_ == kIsobaricSurface) return !IsBetweenPressures(field) && !on_half_level;
  return is_layer == (has_layers_ && !on_half_level);
}

absl::StatusOr<Found> Finder::Levels(const std::optional<absl::Time>& time, bool on_half_levels,
                                     const IsWanted& is_wanted) const {
  Found found;
  for (const Candidate& candidate : At(time)) {
    const grib::Field& field = candidate.Field();
    if (!is_wanted(candidate) || !IsOnLevel(field, on_half_levels)) continue;
    const auto [at, is_new] = found.levels.emplace(field.first.value, candidate.place);
    found.kind = candidate.meaning.kind;
    found.name = NameOf(field);
    // A field that does not change may be repeated at each time.
    if (is_new || !time.has_value()) continue;
    return Refused(absl::StrCat(found.name, " (", grib::NumbersOf(field.parameter),
                                ") is there twice at ", LevelName(type_, field.first.value),
                                " and ", TimeText(*time), "; keep one"));
  }
  return found;
}

absl::StatusOr<Found> Finder::LevelsOf(GribKind kind, const std::optional<absl::Time>& time,
                                       bool on_half_levels) const {
  return Levels(time, on_half_levels,
                [kind](const Candidate& candidate) { return candidate.meaning.kind == kind; });
}

GribSeries Finder::Series(const Found& found, const std::vector<double>& levels) const {
  GribSeries series;
  series.kind = found.kind;
  series.name = found.name;
  for (const double level : levels) {
    const auto at = found.levels.find(level);
    series.levels.push_back(at == found.levels.end() ? GribPlace{} : at->second);
  }
  return series;
}

absl::StatusOr<GribLayers> Finder::FindTime(absl::Time time) {
  GribLayers layers;
  layers.time = time;
  std::vector<Found> needed;
  THUNDERHEAD_RETURN_IF_ERROR(FindHydrometeors(time, layers, needed));
  const std::size_t amounts = needed.size();
  THUNDERHEAD_RETURN_IF_ERROR(FindState(time, needed));
  THUNDERHEAD_RETURN_IF_ERROR(ShareLevels(needed, amounts, layers));
  for (std::size_t i = 0; i < amounts; ++i) {
    GribHydrometeor& hydrometeor = layers.hydrometeors[i];
    hydrometeor.amounts = Series(needed[i], layers.levels);
    THUNDERHEAD_ASSIGN_OR_RETURN(const Found numbers,
                                 Levels(time, false, [&](const Candidate& candidate) {
                                   return candidate.meaning.kind == GribKind::kNumber &&
                                          candidate.meaning.hydrometeor == hydrometeor.hydrometeor;
                                 }));
    hydrometeor.numbers = Optional(numbers, layers.levels, layers);
  }
  layers.temperature = Series(needed[amounts], layers.levels);
  if (needed.size() > amounts + 1) layers.humidity = Series(needed[amounts + 1], layers.levels);
  THUNDERHEAD_RETURN_IF_ERROR(FindSurface(time, layers));
  THUNDERHEAD_RETURN_IF_ERROR(FindHeights(time, layers));
  THUNDERHEAD_RETURN_IF_ERROR(FindMotion(time, layers));
  return layers;
}

absl::StatusOr<GribContents> Finder::Find() {
  THUNDERHEAD_RETURN_IF_ERROR(ChooseLevels());
  THUNDERHEAD_RETURN_IF_ERROR(CheckOneRun());
  std::set<absl::Time> times;
  for (const Candidate& candidate : candidates_) {
    const grib::Field& field = candidate.Field();
    if (candidate.meaning.kind == GribKind::kAmount && IsOnLevel(field, false)) {
      times.insert(field.Valid());
    }
  }
  for (const absl::Time time : times) {
    THUNDERHEAD_ASSIGN_OR_RETURN(GribLayers layers, FindTime(time));
    const bool is_alone = layers.hydrometeors.size() == 1 &&
                          layers.hydrometeors[0].hydrometeor == Hydrometeor::kCloud;
    if (is_alone && contents_.model.splits_cloud) {
      SplitCloud(layers);
      Assume(absl::StrCat(layers.hydrometeors[0].amounts.name,
                          " holds liquid and ice: all ice below -40 C, all liquid above 0 C, mixed "
                          "linearly between."));
    }
    contents_.times.push_back(std::move(layers));
  }
  const GribLayers& first = contents_.times.front();
  for (const GribLayers& layers : contents_.times) {
    if (layers.levels == first.levels && layers.hydrometeors.size() == first.hydrometeors.size() &&
        layers.vertical == first.vertical) {
      continue;
    }
    return Refused(absl::StrCat("has other fields or levels at ", TimeText(layers.time),
                                " than at ", TimeText(first.time),
                                "; get the complete set of fields"));
  }
  const bool has_ratios = std::ranges::any_of(first.hydrometeors, [](const GribHydrometeor& found) {
    return found.quantity == volume::Quantity::kMixingRatio;
  });
  if (has_ratios) {
    const bool is_specific = MeaningOf(first_->parameter).is_specific;
    const bool is_dry = first.hydrometeors[0].per == AirMass::kDry;
    Assume(absl::StrCat(
        "Hydrometeors are taken as kg per kg of ",
        is_dry ? "dry air" : "the whole air (dry air, vapour and condensate)", ", because ",
        is_specific ? "the parameters' definition says so" : contents_.model.why, "."));
  }
  if (contents_.model.microphysics == physics::Microphysics::kThompson) {
    Assume(
        "Particle sizes that the file does not give are those of the Thompson scheme, which HRRR "
        "and RAP use.");
  }
  return std::move(contents_);
}

}  // namespace grib_finder

absl::StatusOr<std::vector<GribContents>> FindGribStorms(const std::string& path,
                                                         const GribIndexes& files) {
  grib_finder::Selections all;
  for (const auto& file : files) {
    for (const grib::Field& field : file->fields) {
      const bool is_on_level = grib_finder::IsLevelType(field.first.type);
      if (!field.is_instant || !is_on_level) continue;
      if (MeaningOf(field.parameter).kind != GribKind::kAmount) continue;
      all.insert({field.origin, field.member});
    }
  }
  THUNDERHEAD_RETURN_IF_ERROR(CheckStormCount(path, all.size()));
  const grib_finder::Candidates candidates = grib_finder::CandidatesOf(files);
  if (all.empty()) return grib_finder::Finder(path, candidates, all, nullptr).Find().status();
  std::vector<GribContents> storms;
  std::size_t fields = 0;
  for (const grib_finder::Selection& wanted : all) {
    grib_finder::Finder finder(path, candidates, all, &wanted);
    fields += finder.Fields();
    // Fields without a member count for each member.
    constexpr std::size_t kMostFields = 10 * grib::kMaxFields;
    if (all.size() > 1 && fields > kMostFields) {
      return absl::InvalidArgumentError(
          absl::StrCat(path, ": its ", all.size(), " storms (runs or members) have more than ",
                       kMostFields, " fields, which are the most; split it"));
    }
    THUNDERHEAD_ASSIGN_OR_RETURN(storms.emplace_back(), finder.Find());
  }
  return storms;
}

}  // namespace thunderhead::storm_files
