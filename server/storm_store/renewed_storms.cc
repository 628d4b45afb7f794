#include "storm_store/renewed_storms.h"

#include <algorithm>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>

namespace thunderhead::storm_store {
namespace {

// Returns whether both storms are the same member of the same run.
bool IsSameMember(const CataloguedStorm& one, const CataloguedStorm& other) {
  if (one.files.empty() || other.files.empty()) return false;
  const storm_files::StormFile& a = one.files.front();
  const storm_files::StormFile& b = other.files.front();
  return a.run == b.run && a.member == b.member;
}

// Inserts time `time` of the storm `from`, whose file is gone, into `storm`, marked as deleted.
void InsertDeleted(const CataloguedStorm& from, std::size_t time, CataloguedStorm& storm) {
  const absl::Time valid = ValidTimeOf(from, time);
  std::size_t at = 0;
  while (at < storm.sources.size() && ValidTimeOf(storm, at) < valid) ++at;
  StormTime kept = from.info.times[time];
  kept.deleted = true;
  // The storm may now begin with another time, at another place.
  kept.middle = MiddleOf(from.info, time);
  kept.projection = ProjectionTextOf(from.info, time);
  storm.files.push_back(FileOf(from, time));
  storm.sources.insert(storm.sources.begin() + static_cast<std::ptrdiff_t>(at),
                       {storm.files.size() - 1, from.sources[time].record});
  storm.info.times.insert(storm.info.times.begin() + static_cast<std::ptrdiff_t>(at),
                          std::move(kept));
}

}  // namespace

std::vector<std::optional<std::size_t>> MatchStorms(
    const std::vector<const CataloguedStorm*>& known, const std::vector<CataloguedStorm>& found) {
  // Pairs are sorted by the number of common files, then by an equal run and member, then by their
  // order. Several runs or members may share one file.
  std::vector<std::tuple<std::size_t, bool, std::size_t, std::size_t>> pairs;
  std::multimap<std::string_view, std::size_t> found_by_file;
  for (std::size_t f = 0; f < found.size(); ++f) {
    for (const std::string& file : found[f].info.files) found_by_file.emplace(file, f);
  }
  for (std::size_t k = 0; k < known.size(); ++k) {
    if (known[k] == nullptr) continue;
    const std::vector<std::string>& names = known[k]->info.files;
    const std::set<std::string_view> files(names.begin(), names.end());
    std::map<std::size_t, std::size_t> common;  // number of common files, by index in `found`
    for (const std::string_view file : files) {
      const auto [begin, end] = found_by_file.equal_range(file);
      for (auto at = begin; at != end; ++at) ++common[at->second];
    }
    for (const auto& [f, count] : common) {
      pairs.emplace_back(count, IsSameMember(*known[k], found[f]), k, f);
    }
  }
  std::ranges::stable_sort(pairs, std::greater(), [](const auto& pair) {
    return std::pair(std::get<0>(pair), std::get<1>(pair));
  });
  std::vector<std::optional<std::size_t>> match(known.size());
  std::set<std::size_t> taken;
  for (const auto& [common, is_same_member, k, f] : pairs) {
    if (!match[k].has_value() && taken.insert(f).second) match[k] = f;
  }
  return match;
}

bool IsSameTime(const CataloguedStorm& one, std::size_t one_time, const CataloguedStorm& other,
                std::size_t other_time) {
  const storm_files::StormFile& a = FileOf(one, one_time);
  const storm_files::StormFile& b = FileOf(other, other_time);
  return a.path == b.path && a.version == b.version &&
         one.sources[one_time].record == other.sources[other_time].record &&
         ValidTimeOf(one, one_time) == ValidTimeOf(other, other_time);
}

std::optional<CataloguedStorm> Renewed(const CataloguedStorm& known,
                                       std::optional<CataloguedStorm> found,
                                       const std::function<bool(std::size_t time)>& kept) {
  std::set<std::string> there;
  if (found.has_value()) {
    for (const StormTime& time : found->info.times) there.insert(time.valid_time);
  }
  CataloguedStorm renewed;
  if (found.has_value()) {
    renewed = *std::move(found);
  } else {
    renewed.info = known.info;
    renewed.stem = known.stem;
    renewed.info.times.clear();
  }
  for (std::size_t time = 0; time < known.info.times.size(); ++time) {
    if (there.contains(known.info.times[time].valid_time) || !kept(time)) continue;
    InsertDeleted(known, time, renewed);
  }
  if (renewed.sources.empty()) return std::nullopt;
  CountTimes(renewed);
  return renewed;
}

bool IsUnchanged(const CataloguedStorm& before, const CataloguedStorm& after) {
  if (before.info.id != after.info.id || before.info.title != after.info.title ||
      before.info.times != after.info.times || before.info.files != after.info.files) {
    return false;
  }
  for (std::size_t time = 0; time < before.sources.size(); ++time) {
    if (!IsSameTime(before, time, after, time)) return false;
  }
  return true;
}

}  // namespace thunderhead::storm_store
