#include "storm_files/grib_finder.h"

#include <algorithm>
#include <array>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "base/status.h"

namespace thunderhead::storm_files::grib_finder {

// Finds the hydrometeors at `time`, and adds one element to `needed` for each.
absl::Status Finder::FindHydrometeors(absl::Time time, GribLayers& layers,
                                      std::vector<Found>& needed) {
  for (const physics::Hydrometeor hydrometeor : physics::kHydrometeors) {
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

// Returns an error if the field is there on the storm's levels, but on another grid.
absl::Status Finder::CheckOtherGrids(GribKind kind) const {
  for (const Candidate& candidate : candidates_) {
    const grib::Field& field = candidate.Field();
    if (candidate.meaning.kind != kind || field.first.type != type_) continue;
    if (IsSameGrid(field, *first_)) continue;
    const auto other = grib::ReadGrid(*field.grid);
    return Refused(absl::StrCat("has ", NameOf(field), " on another grid than the hydrometeors",
                                other.ok() ? "; put all fields on one grid"
                                           : absl::StrCat(": ", other.status().message())));
  }
  return absl::OkStatus();
}

// Adds temperature and, if the file has it, humidity to `needed`. Returns an error if there is no
// temperature.
absl::Status Finder::FindState(absl::Time time, std::vector<Found>& needed) {
  THUNDERHEAD_ASSIGN_OR_RETURN(Found temperature, LevelsOf(GribKind::kTemperature, time));
  if (temperature.levels.empty()) {
    THUNDERHEAD_RETURN_IF_ERROR(CheckOtherGrids(GribKind::kTemperature));
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
    // Heights on generalized levels are those of half levels, of which there is one more.
    const bool is_half_level =
        type_ == kGeneralized && candidate.meaning.kind == GribKind::kGeometricHeight;
    if (is_half_level) continue;
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
  // Only levels below or above all shared ones are added. Between them, the file may have
  // temperature on levels that it lacks for hydrometeors.
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

}  // namespace thunderhead::storm_files::grib_finder
