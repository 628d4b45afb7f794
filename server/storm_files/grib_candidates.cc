#include <algorithm>
#include <iterator>

#include "storm_files/grib_finder.h"
#include "storm_files/grib_parameters.h"

namespace thunderhead::storm_files::grib_finder {
namespace {

// Decides which fields belong to a storm.
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

}  // namespace

bool IsSameGrid(const grib::Field& one, const grib::Field& other) {
  return one.grid == other.grid || *one.grid == *other.grid;
}

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

}  // namespace thunderhead::storm_files::grib_finder
