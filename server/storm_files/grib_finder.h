// Finds the fields of one run and member in the indexes of GRIB files. Only FindGribStorms
// (grib_layers.h) uses it. The file grib_candidates.cc has the fields of a storm, and
// grib_layers.cc puts those of a time together. The file grib_levels.cc finds hydrometeors, the
// state of the air and the levels that they share. The file grib_heights.cc finds heights, the
// ground and motion.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/str_cat.h"
#include "physics/hydrometeors.h"
#include "storm_files/grib_layers.h"

namespace thunderhead::storm_files::grib_finder {

// Types of surfaces (code table 4.5).
inline constexpr int kGround = 1;
inline constexpr int kIsobaricSurface = 100;
inline constexpr int kHybrid = 105;
inline constexpr int kHybridHeight = 118;
inline constexpr int kHybridPressure = 119;
inline constexpr int kGeneralized = 150;

// Returns the name of the storm's levels, such as "hybrid levels".
std::string LevelKind(int type);

// Returns the name of one level, such as "hybrid level 5" or "850 hPa".
std::string LevelName(int type, double value);

bool IsHeight(GribKind kind);

// Returns whether the field is a mean between two pressures.
bool IsBetweenPressures(const grib::Field& field);

std::string TimeText(absl::Time time);

struct Candidate {
  GribPlace place;
  GribMeaning meaning;

  const grib::Field& Field() const { return *place.field; }
};

using Candidates = std::vector<Candidate>;

// Returns the fields of the files that a storm may need.
Candidates CandidatesOf(const GribIndexes& files);

// Returns whether two fields are on the same grid. Fields of one message share a grid section,
// which can be much longer than the rest of a field.
bool IsSameGrid(const grib::Field& one, const grib::Field& other);

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
  absl::Status CheckOtherGrids(GribKind kind) const;
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

  // Returns the levels of the fields that fulfil `is_wanted`. It is an error if two of them are on
  // one level. `time` is absent for fields that do not change with time.
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
  // Adds an assumption that may differ from time to time. Only the first `kMost` are kept.
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
  // Fields by time and by kind, collected once because a file may have very many times.
  std::map<absl::Time, Candidates> candidates_at_;
  std::map<physics::Hydrometeor, std::map<grib::Parameter, GribMeaning>> parameters_;
  std::map<GribKind, std::optional<GribPlace>> at_ground_at_any_time_;
  std::optional<Found> half_heights_;
  std::size_t assumptions_of_times_ = 0;
  int type_ = 0;                        // the type of the storm's levels
  bool has_layers_ = false;             // true if amounts lie between two half levels
  const grib::Field* first_ = nullptr;  // the first field of a hydrometeor
};

}  // namespace thunderhead::storm_files::grib_finder
