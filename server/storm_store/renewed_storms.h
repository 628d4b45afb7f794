// Matches the storms that the store already knows with the storms that a new search finds. These
// pure functions decide which found storm continues which known storm, and which times stay
// although their files are gone.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "storm_store/storm_catalogue.h"

namespace thunderhead::storm_store {

// Returns for each storm of `known` the index in `found` of the storm that continues it, or
// nothing. This is the found storm that shares the most files with it. If several share equally
// many, it is the one of the same run and member. Each found storm continues at most one known
// storm. Ids are not compared, because a run of one file gets another id when it becomes a series.
// An element of `known` may be null.
std::vector<std::optional<std::size_t>> MatchStorms(
    const std::vector<const CataloguedStorm*>& known, const std::vector<CataloguedStorm>& found);

// Returns whether both times are the same record of the same version of the same file, with the
// same valid time.
bool IsSameTime(const CataloguedStorm& one, std::size_t one_time, const CataloguedStorm& other,
                std::size_t other_time);

// Returns `found` plus those times of `known` that `found` lacks and for which `kept` returns true.
// The added times are marked as deleted. Without `found`, the result has only the added times.
// Returns nothing if no time is left.
std::optional<CataloguedStorm> Renewed(const CataloguedStorm& known,
                                       std::optional<CataloguedStorm> found,
                                       const std::function<bool(std::size_t time)>& kept);

// Returns whether the storm is unchanged for clients, and its cached fields are still up to date.
bool IsUnchanged(const CataloguedStorm& before, const CataloguedStorm& after);

}  // namespace thunderhead::storm_store
