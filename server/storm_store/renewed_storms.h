// Matches known storms with files that are found again: which is which, and which times stay though
// their files are gone. Pure functions.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "storm_store/storm_catalogue.h"

namespace thunderhead::storm_store {

// For each of `known` the one of `found` that continues it: the one with most of its files, if any.
// A run of one file that becomes a series has another id, but is the same storm. A null is no
// storm. Two never continue as one.
std::vector<std::optional<std::size_t>> MatchStorms(
    const std::vector<const CataloguedStorm*>& known, const std::vector<CataloguedStorm>& found);

// True if both are the same record of the same file.
bool IsSameTime(const CataloguedStorm& one, std::size_t one_time, const CataloguedStorm& other,
                std::size_t other_time);

// `found` with those times of `known` that it lacks and that are `kept`, marked as deleted; without
// `found` only these. Nothing if no time is left.
std::optional<CataloguedStorm> Renewed(const CataloguedStorm& known,
                                       std::optional<CataloguedStorm> found,
                                       const std::function<bool(std::size_t time)>& kept);

// True if clients see no difference, and what is cached is still what is there.
bool IsUnchanged(const CataloguedStorm& before, const CataloguedStorm& after);

}  // namespace thunderhead::storm_store
