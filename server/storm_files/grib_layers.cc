#include "storm_files/grib_layers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <tuple>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "base/status.h"
#include "storm_files/grib_parts.h"
#include "storm_files/storm_file.h"

namespace thunderhead::storm_files {
namespace {

using physics::Hydrometeor;

// Types of surfaces (code table 4.5).
constexpr int kGround = 1;
constexpr int kIsobaricSurface = 100;
constexpr int kHybrid = 105;
constexpr int kHybridHeight = 118;
constexpr int kHybridPressure = 119;
constexpr int kGeneralized = 150;

// The types of levels that a storm may have. If two have equally many levels, the first is used.
constexpr std::array kLevelTypes = {kHybrid, kGeneralized, kHybridHeight, kHybridPressure,
                                    kIsobaricSurface};

// Returns the name of the storm's levels, "hybrid levels".
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

// Returns the name of one level, "hybrid level 5" or "850 hPa".
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

// Returns whether the field is a mean between two pressures.
bool IsBetweenPressures(const grib::Field& field) {
  return field.first.type == kIsobaricSurface && field.second.type == kIsobaricSurface;
}

std::string TimeText(absl::Time time) {
  return absl::FormatTime("%Y-%m-%d %H:%M UTC", time, absl::UTCTimeZone());
}

struct Candidate {
  GribPlace place;
  GribMeaning meaning;

  const grib::Field& Field() const { return *place.field; }
};

using Candidates = std::vector<Candidate>;

// Returns whether two fields are on the same grid. Fields of one message share a grid section,
// which can be much longer than the rest of a field.
bool IsSameGrid(const grib::Field& one, const grib::Field& other) {
  return one.grid == other.grid || *one.grid == *other.grid;
}

using ByLevel = std::map<double, GribPlace>;

// A field with the levels on which it is.
struct Found {
  GribKind kind = GribKind::kNone;
  std::string name;
  ByLevel levels;
};

// The run and member of a storm. Runs are in order of time.
struct Selection {
  grib::Origin origin;
  std::optional<int> member;

  bool operator<(const Selection& other) const {
    const auto key = [](const Selection& of) {
      return std::tuple(of.origin.reference, of.origin.centre, of.origin.subcentre, of.member);
    };
    return key(*this) < key(other);
  }
};

// The storms of the files. It is empty if they have no hydrometeors.
using Selections = std::set<Selection>;

class Finder {
 public:
  // `wanted` is null if the files have no hydrometeors. `candidates` are the fields of all storms.
  Finder(const std::string& path, const Candidates& candidates, const Selections& all,
         const Selection* wanted);

  // Returns the number of fields that belong to the storm.
  std::size_t Fields() const { return candidates_.size(); }

  absl::StatusOr<GribContents> Find();

 private:
  absl::Status ChooseLevels();
  absl::Status CheckOneRun();
  absl::Status FindCells();
  absl::StatusOr<GribLayers> FindTime(absl::Time time);
  absl::Status FindHydrometeors(absl::Time time, GribLayers& layers, std::vector<Found>& needed);
  absl::Status FindState(absl::Time time, std::vector<Found>& needed);
  absl::Status ShareLevels(std::vector<Found>& needed, std::size_t amounts, GribLayers& layers);
  absl::Status ShareModelLevels(const std::vector<Found>& needed, const std::set<double>& all,
                                GribLayers& layers);
  std::set<double> LevelsOfState(absl::Time time) const;
  absl::Status CheckLastLevel(const GribLayers& layers) const;
  absl::Status FindHeights(absl::Time time, GribLayers& layers);
  absl::Status FindIsobaricHeights(absl::Time time, GribLayers& layers);
  absl::Status FindHydrostatic(absl::Time time, GribLayers& layers);
  absl::Status FindHalfHeights(GribLayers& layers);
  GribSeries Optional(const Found& found, const std::vector<double>& levels,
                      const GribLayers& layers);
  absl::Status FindSurface(absl::Time time, GribLayers& layers);
  absl::Status FindMotion(absl::Time time, GribLayers& layers);

  // Returns the levels of the fields that fulfil `is_wanted`. It is an error if a level has two.
  // `time` is absent for fields that do not change with time.
  using IsWanted = std::function<bool(const Candidate&)>;
  absl::StatusOr<Found> Levels(const std::optional<absl::Time>& time, bool on_half_levels,
                               const IsWanted& is_wanted) const;
  absl::StatusOr<Found> LevelsOf(GribKind kind, const std::optional<absl::Time>& time,
                                 bool on_half_levels = false) const;
  absl::StatusOr<std::optional<GribPlace>> AtGround(GribKind kind, absl::Time time,
                                                    bool at_any_time);

  // Returns the storm's fields that are valid at `time`, or all of them without a time.
  const Candidates& At(const std::optional<absl::Time>& time) const;
  const std::optional<GribPlace>& AtGroundAtAnyTime(GribKind kind);
  bool IsAtGround(const Candidate& candidate, GribKind kind) const;
  bool IsOnLevel(const grib::Field& field, bool on_half_level) const;
  std::string Where() const;
  std::string NameOf(const grib::Field& field) const {
    return GribNameOf(field.parameter, field.origin.centre);
  }
  std::string Described(const Found& found) const {
    if (found.levels.empty()) return found.name;
    return absl::StrCat(found.name, " (",
                        grib::NumbersOf(found.levels.begin()->second.field->parameter), ")");
  }
  absl::Status Refused(std::string_view what) const {
    return absl::InvalidArgumentError(absl::StrCat(Where(), ": ", std::string(what)));
  }
  absl::Status Missing(std::string_view what, absl::Time time) const {
    return absl::DataLossError(absl::StrCat(Where(), ": ", std::string(what), " is missing at ",
                                            TimeText(time), "; get the complete set of fields"));
  }
  void Assume(std::string sentence) {
    std::vector<std::string>& all = contents_.assumptions;
    if (std::ranges::find(all, sentence) == all.end()) all.push_back(std::move(sentence));
  }
  // Adds an assumption that may be another one at each time. Of very many, the first are kept.
  void AssumeOfTime(std::string sentence) {
    constexpr std::size_t kMost = 20;
    if (assumptions_of_times_ >= kMost) return;
    const std::size_t before = contents_.assumptions.size();
    Assume(std::move(sentence));
    assumptions_of_times_ += contents_.assumptions.size() - before;
  }
  GribSeries Series(const Found& found, const std::vector<double>& levels) const;

  const Selections& all_;
  const Selection* const wanted_;
  GribContents contents_;
  Candidates candidates_;
  // What the search for each time needs, collected once. A file may have very many times.
  std::map<absl::Time, Candidates> candidates_at_;
  std::map<Hydrometeor, std::map<grib::Parameter, GribMeaning>> parameters_;
  std::map<GribKind, std::optional<GribPlace>> at_ground_at_any_time_;
  std::optional<Found> half_heights_;
  std::size_t assumptions_of_times_ = 0;
  int type_ = 0;                        // the type of the storm's levels
  bool has_layers_ = false;             // true if amounts lie between two half levels
  const grib::Field* first_ = nullptr;  // the first field of a hydrometeor
};

// Returns the files' path, with the run and member if there are several.
std::string Finder::Where() const {
  if (all_.size() < 2) return contents_.path;
  const std::string member = GribMemberOf(wanted_->member);
  return absl::StrCat(contents_.path, " (run ", TimeText(wanted_->origin.reference),
                      member.empty() ? "" : ", ", member, ")");
}

// Tells which fields belong to a storm.
class StormFields {
 public:
  StormFields(const Selections& all, const Selection& wanted)
      : wanted_(wanted),
        is_alone_(all.size() < 2),
        are_one_run_(std::ranges::all_of(
            all, [&](const Selection& each) { return each.origin == wanted.origin; })),
        has_hydrometeors_without_member_(all.contains({wanted.origin, std::nullopt})) {}

  // Returns whether the field belongs to the storm that is wanted. If all storms are of one run,
  // fields of other runs are taken here and reported later.
  bool Has(const Candidate& candidate) const {
    if (is_alone_) return true;
    const grib::Field& field = candidate.Field();
    if (!are_one_run_ && field.origin != wanted_.origin) return false;
    if (field.member.has_value()) return field.member == wanted_.member;
    const GribKind kind = candidate.meaning.kind;
    if (!wanted_.member.has_value() || kind == GribKind::kGeometricHeight) return true;
    if (field.first.type == kGround && IsHeight(kind)) return true;
    return !has_hydrometeors_without_member_;
  }

 private:
  const Selection& wanted_;
  const bool is_alone_;
  const bool are_one_run_;
  const bool has_hydrometeors_without_member_;
};

// Returns the fields of the files that a storm may need.
Candidates CandidatesOf(const GribIndexes& files) {
  Candidates candidates;
  for (std::size_t file = 0; file < files.size(); ++file) {
    for (const grib::Field& field : files[file]->fields) {
      if (!field.is_instant) continue;
      const GribMeaning meaning = MeaningOf(field.parameter);
      if (meaning.kind != GribKind::kNone) candidates.push_back({{file, &field}, meaning});
    }
  }
  return candidates;
}

Finder::Finder(const std::string& path, const Candidates& candidates, const Selections& all,
               const Selection* wanted)
    : all_(all), wanted_(wanted) {
  contents_.path = path;
  if (wanted == nullptr) {
    candidates_ = candidates;
  } else {
    std::ranges::copy_if(candidates, std::back_inserter(candidates_),
                         [of_storm = StormFields(all, *wanted)](const Candidate& candidate) {
                           return of_storm.Has(candidate);
                         });
  }
  for (const Candidate& candidate : candidates_) {
    candidates_at_[candidate.Field().Valid()].push_back(candidate);
    const GribMeaning& meaning = candidate.meaning;
    if (meaning.kind != GribKind::kAmount) continue;
    parameters_[meaning.hydrometeor].emplace(candidate.Field().parameter, meaning);
  }
}

const Candidates& Finder::At(const std::optional<absl::Time>& time) const {
  static const Candidates none;
  if (!time.has_value()) return candidates_;
  const auto at = candidates_at_.find(*time);
  return at == candidates_at_.end() ? none : at->second;
}

// Chooses the type of levels on which hydrometeors have the most levels. A file on isobaric levels
// can have its hydrometeors also on one hybrid level, which is no part of the set.
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
  return contents_.grid.IsUnstructured() ? FindCells() : absl::OkStatus();
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

// Finds the hydrometeors at `time`, and adds one element to `needed` for each.
absl::Status Finder::FindHydrometeors(absl::Time time, GribLayers& layers,
                                      std::vector<Found>& needed) {
  for (const Hydrometeor hydrometeor : physics::kHydrometeors) {
    // If there are several parameters for one hydrometeor, the one on the most levels is used.
    Found best;
    GribHydrometeor found;
    for (const auto& [parameter, meaning] : parameters_[hydrometeor]) {
      THUNDERHEAD_ASSIGN_OR_RETURN(
          Found levels, Levels(time, false, [&wanted = parameter](const Candidate& candidate) {
            return candidate.Field().parameter == wanted;
          }));
      if (levels.levels.size() <= best.levels.size()) continue;
      best = std::move(levels);
      found.hydrometeor = hydrometeor;
      found.quantity = meaning.quantity;
      found.per = meaning.is_specific ? AirMass::kWhole : contents_.model.mixing_ratios_per;
    }
    if (best.levels.empty()) continue;
    layers.hydrometeors.push_back(std::move(found));
    needed.push_back(std::move(best));
  }
  return absl::OkStatus();
}

// Adds temperature, humidity and, on model levels that need it, pressure to `needed`.
absl::Status Finder::FindState(absl::Time time, std::vector<Found>& needed) {
  THUNDERHEAD_ASSIGN_OR_RETURN(Found temperature, LevelsOf(GribKind::kTemperature, time));
  if (temperature.levels.empty()) {
    return Missing(GribKindName(GribKind::kTemperature), time);
  }
  needed.push_back(std::move(temperature));
  Found humidity;
  for (const GribKind kind :
       {GribKind::kSpecificHumidity, GribKind::kVapourRatio, GribKind::kRelativeHumidity}) {
    THUNDERHEAD_ASSIGN_OR_RETURN(Found found, LevelsOf(kind, time));
    if (found.levels.size() > humidity.levels.size()) humidity = std::move(found);
  }
  if (humidity.levels.empty()) {
    Assume("The air is treated as dry, because the file has no humidity.");
  } else {
    if (humidity.kind == GribKind::kRelativeHumidity) {
      Assume("Vapour is computed from the relative humidity over water.");
    }
    needed.push_back(std::move(humidity));
  }
  return absl::OkStatus();
}

// Returns the levels of temperature, humidity, pressure and heights at `time`. If a file was cut
// short between two messages, these may have more levels than the hydrometeors.
std::set<double> Finder::LevelsOfState(absl::Time time) const {
  constexpr std::array kState = {GribKind::kTemperature,       GribKind::kSpecificHumidity,
                                 GribKind::kVapourRatio,       GribKind::kRelativeHumidity,
                                 GribKind::kPressure,          GribKind::kGeometricHeight,
                                 GribKind::kGeopotentialHeight};
  std::set<double> levels;
  for (const Candidate& candidate : At(time)) {
    if (std::ranges::find(kState, candidate.meaning.kind) == kState.end()) continue;
    const grib::Field& field = candidate.Field();
    if (IsOnLevel(field, false)) levels.insert(field.first.value);
  }
  return levels;
}

// Model levels must be complete, because each is a part of the column.
absl::Status Finder::ShareModelLevels(const std::vector<Found>& needed, const std::set<double>& all,
                                      GribLayers& layers) {
  double expected = *all.begin();
  for (const double level : all) {
    if (level != expected) {
      return Missing(absl::StrCat("every field of ", LevelName(type_, expected)), layers.time);
    }
    expected += 1.0;
    for (const Found& found : needed) {
      if (found.levels.contains(level)) continue;
      return Missing(absl::StrCat(Described(found), " of ", LevelName(type_, level)), layers.time);
    }
  }
  layers.levels.assign(all.begin(), all.end());
  return absl::OkStatus();
}

// Sets the levels that all needed fields share. The first `amounts` of them are hydrometeors.
absl::Status Finder::ShareLevels(std::vector<Found>& needed, std::size_t amounts,
                                 GribLayers& layers) {
  std::set<double> all;
  for (std::size_t i = 0; i < amounts; ++i) {
    for (const auto& [level, place] : needed[i].levels) all.insert(level);
  }
  const std::set<double> of_state = LevelsOfState(layers.time);
  if (type_ != kIsobaricSurface) {
    all.insert(of_state.begin(), of_state.end());
    return ShareModelLevels(needed, all, layers);
  }
  std::set<double> shared = all;
  for (const Found& found : needed) {
    std::erase_if(shared, [&](double level) { return !found.levels.contains(level); });
  }
  if (shared.size() < 2) {
    return Refused("has hydrometeors, temperature and humidity together on fewer than two levels");
  }
  std::vector<std::string> left_out;
  // Between the shared levels, temperature may be on levels that no hydrometeor is on.
  for (const double level : of_state) {
    if (level < *shared.begin() || level > *shared.rbegin()) all.insert(level);
  }
  for (const double level : all) {
    if (shared.contains(level)) continue;
    if (level < *shared.begin() || level > *shared.rbegin()) {
      left_out.push_back(LevelName(type_, level));
      continue;
    }
    for (const Found& found : needed) {
      if (found.levels.contains(level)) continue;
      return Missing(absl::StrCat(Described(found), " of ", LevelName(type_, level)), layers.time);
    }
  }
  if (!left_out.empty()) {
    AssumeOfTime(absl::StrCat(
        "Levels that not all fields have are left out: ", absl::StrJoin(left_out, ", "), "."));
  }
  // Pressure falls upwards.
  layers.levels.assign(shared.rbegin(), shared.rend());
  return absl::OkStatus();
}

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
  for (const double level : half_levels) {
    if (found.levels.contains(level)) continue;
    return Missing(absl::StrCat(Described(found), " of half level ", level), layers.time);
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
  if (has_layers_) THUNDERHEAD_RETURN_IF_ERROR(FindHalfHeights(layers));
  if (layers.heights.Empty()) {
    for (const GribKind kind :
         {GribKind::kGeometricHeight, GribKind::kGeopotentialHeight, GribKind::kGeopotential}) {
      THUNDERHEAD_ASSIGN_OR_RETURN(const Found found, LevelsOf(kind, time));
      // One level is the ground's geopotential of IFS.
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

// Splits cloud water that holds liquid and ice into two hydrometeors.
void SplitCloud(GribLayers& layers) {
  GribHydrometeor ice = layers.hydrometeors.front();
  layers.hydrometeors.front().is_split = true;
  ice.hydrometeor = Hydrometeor::kIce;
  ice.is_split = true;
  layers.hydrometeors.push_back(std::move(ice));
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

}  // namespace

absl::StatusOr<std::vector<GribContents>> FindGribStorms(const std::string& path,
                                                         const GribIndexes& files) {
  Selections all;
  for (const auto& file : files) {
    for (const grib::Field& field : file->fields) {
      const bool is_on_level =
          std::ranges::find(kLevelTypes, field.first.type) != kLevelTypes.end();
      if (!field.is_instant || !is_on_level) continue;
      if (MeaningOf(field.parameter).kind != GribKind::kAmount) continue;
      all.insert({field.origin, field.member});
    }
  }
  THUNDERHEAD_RETURN_IF_ERROR(CheckStormCount(path, all.size()));
  const Candidates candidates = CandidatesOf(files);
  if (all.empty()) return Finder(path, candidates, all, nullptr).Find().status();
  std::vector<GribContents> storms;
  std::size_t fields = 0;
  for (const Selection& wanted : all) {
    Finder finder(path, candidates, all, &wanted);
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
