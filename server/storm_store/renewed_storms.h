// Matches known storms with files that are found again. Decides which storm is which, and which
// times stay although their files are gone. These are pure functions.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "storm_store/storm_catalogue.h"

namespace thunderhead::storm_store {

// Returns for each of `known` the storm of `found` that continues it: the one with most of its
// files, if any. A run of one file that becomes a series has another id, but is the same storm. A
// null is no storm. No two storms continue as the same one.
std::vector<std::optional<std::size_t>> MatchStorms(
    const std::vector<const CataloguedStorm*>& known, const std::vector<CataloguedStorm>& found);

// Returns whether both are the same record of the same file.
bool IsSameTime(const CataloguedStorm& one, std::size_t one_time, const CataloguedStorm& other,
                std::size_t other_time);

// Returns `found` together with the times of `known` that it lacks and that are `kept`, marked as
// deleted. Without `found`, returns only these times. Returns nothing if no time is left.
std::optional<CataloguedStorm> Renewed(const CataloguedStorm& known,
                                       std::optional<CataloguedStorm> found,
                                       const std::function<bool(std::size_t time)>& kept);

// Returns whether clients see no difference, and cached fields are still those of the files.
bool IsUnchanged(const CataloguedStorm& before, const CataloguedStorm& after);

}  // namespace thunderhead::storm_store
