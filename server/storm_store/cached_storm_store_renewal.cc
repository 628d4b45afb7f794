// The part of CachedStormStore that follows changes in its folders.
#include <algorithm>
#include <chrono>
#include <map>
#include <set>
#include <string_view>
#include <tuple>
#include <utility>

#include "absl/strings/str_cat.h"
#include "spdlog/spdlog.h"
#include "storm_store/cached_storm_store.h"
#include "storm_store/renewed_storms.h"

namespace thunderhead::storm_store {
namespace {

// The longest time for which LetReadersGoFirst waits. A hanging read must not stop the catalogue
// for other storms.
constexpr std::chrono::seconds kLongestCourtesy{10};

void Log(const StormChange& change) {
  const auto times = [](const StormInfoPtr& storm) { return storm->times.size(); };
  if (change.before == nullptr) {
    spdlog::info("storm {} was added, with {} times", change.after->id, times(change.after));
  } else if (change.after == nullptr) {
    spdlog::info("storm {} was removed", change.before->id);
  } else {
    spdlog::info("storm {} was changed: it has {} times and had {}", change.after->id,
                 times(change.after), times(change.before));
  }
}

// Returns the indices of the storms that are not known and were not added. Those that an earlier
// store knew come first.
std::vector<std::size_t> NewStorms(const std::vector<CataloguedStorm>& found,
                                   const std::vector<std::optional<std::size_t>>& place_of,
                                   const std::set<std::string>& added, const StormIds& earlier) {
  std::vector<std::size_t> fresh;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const bool is_added = std::ranges::all_of(
        found[i].info.files, [&](const std::string& file) { return added.contains(file); });
    if (!place_of[i].has_value() && !is_added) fresh.push_back(i);
  }
  std::stable_partition(fresh.begin(), fresh.end(),
                        [&](std::size_t i) { return earlier.Of(found[i]).has_value(); });
  return fresh;
}

}  // namespace

void CachedStormStore::Listen(CatalogueListener listener) {
  const std::lock_guard lock(listening_);
  listener_ = std::move(listener);
}

void CachedStormStore::Follow(std::unique_ptr<CatalogueScan> scan) {
  searching_ = true;
  live_ = std::make_unique<LiveCatalogue>(
      std::move(scan), *options_.live, *options_.time,
      [weak = weak_from_this()](const CatalogueScan::Result& found) {
        if (const auto store = weak.lock()) store->TakeFound(found);
      });
}

void CachedStormStore::TakeFound(const CatalogueScan::Result& found) {
  Renew(found.storms);
  {
    const std::lock_guard lock(listening_);
    following_ = true;
  }
  KeepIds();
  // The only storm may be a file that is still being written, so the search continues.
  if (found.storms.empty() && found.look_again_at.has_value()) return;
  if (found.has_untried) return;
  {
    const Lock lock(mutex_);
    searching_ = false;
  }
  changed_.notify_all();
}

bool CachedStormStore::AwaitFirstSearch() {
  Lock lock(mutex_);
  return base::WaitUntil(*options_.time, changed_, lock, Now() + options_.live->first_search,
                         [this] { return !searching_; });
}

bool CachedStormStore::IsSearching() const {
  const Lock lock(mutex_);
  return searching_;
}

void CachedStormStore::LetReadersGoFirst() {
  Lock lock(mutex_);
  base::WaitUntil(*options_.time, changed_, lock, Now() + kLongestCourtesy,
                  [this] { return ending_ || asked_reads_ == 0; });
}

void CachedStormStore::Renew(const std::vector<CataloguedStorm>& found) {
  const std::lock_guard one_at_a_time(listening_);
  CatalogueChange changes;
  {
    const Lock lock(mutex_);
    copies_.clear();
    std::vector<const CataloguedStorm*> known;
    std::set<std::string> added;
    for (const Held& held : storms_) {
      known.push_back(held.added ? nullptr : held.storm.get());
      if (held.added && held.storm != nullptr) {
        added.insert(held.storm->info.files.begin(), held.storm->info.files.end());
      }
    }
    const auto match = MatchStorms(known, found);
    std::vector<std::optional<std::size_t>> place_of(found.size());
    const auto take = [&](std::size_t place, std::optional<CataloguedStorm> storm) {
      const StormChange change = Replace(place, std::move(storm));
      if (change.before != change.after) changes.push_back(change);
    };
    // Ids are given to known storms first, and then to new ones. Otherwise a new file with the name
    // of a known storm's file could get its id, and clients would be shown another storm. Storms
    // that are gone are removed before, so that other storms can take their ids.
    for (std::size_t place = 0; place < known.size(); ++place) {
      if (known[place] != nullptr && !match[place].has_value()) take(place, std::nullopt);
    }
    for (std::size_t place = 0; place < known.size(); ++place) {
      if (!match[place].has_value()) continue;
      place_of[*match[place]] = place;
      take(place, found[*match[place]]);
    }
    for (const std::size_t i : NewStorms(found, place_of, added, earlier_ids_)) {
      place_of[i] = storms_.size();
      storms_.emplace_back();
      take(*place_of[i], found[i]);
    }
    std::vector<std::tuple<std::size_t, std::string, std::size_t>> listed;  // path, id and place
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (!place_of[i].has_value()) continue;
      listed.emplace_back(found[i].path, storms_[*place_of[i]].storm->info.id, *place_of[i]);
    }
    std::ranges::sort(listed);
    std::vector<std::size_t> order;
    order.reserve(listed.size());
    for (const auto& [path, id, place] : listed) order.push_back(place);
    // Storms that are only in memory, and storms that were added, come last.
    for (const std::size_t place : order_) {
      const bool stays = storms_[place].storm != nullptr;
      if (stays && std::ranges::find(order, place) == order.end()) order.push_back(place);
    }
    order_ = std::move(order);
  }
  if (changes.empty()) return;
  changed_.notify_all();
  for (const StormChange& change : changes) {
    if (following_) Log(change);
  }
  if (listener_) listener_(changes);
}

// Replaces the storm at `place`, if there is one, by `found`. Times that `found` lacks stay while
// they are in use.
StormChange CachedStormStore::Replace(std::size_t place, std::optional<CataloguedStorm> found) {
  Held& held = storms_[place];
  StormChange change;
  if (held.storm != nullptr) {
    change.before = held.Info();
    const auto in_use = [&](std::size_t time) { return cache_.InUse({place, held.numbers[time]}); };
    if (found.has_value()) {
      const bool same_name = found->stem == held.storm->stem;
      found->info.id = same_name ? held.storm->info.id : NewId(*found, place);
    }
    found = Renewed(*held.storm, std::move(found), in_use);
  } else if (found.has_value()) {
    found->info.id = NewId(*found, place);
  }
  const bool unchanged =
      held.storm != nullptr && found.has_value() && IsUnchanged(*held.storm, *found);
  if (unchanged) {
    change.after = change.before;
    return change;
  }
  std::vector<int> numbers;
  std::set<int> kept;
  // A storm may have a million times, and readers wait for the lock. Equal times are therefore
  // looked up, by the members that IsSameTime compares.
  std::map<std::tuple<std::string_view, std::uint64_t, std::size_t, absl::Time>, std::size_t>
      old_times;
  const auto key_of = [](const CataloguedStorm& storm, std::size_t time) {
    const storm_files::StormFile& file = FileOf(storm, time);
    const std::size_t record = storm.sources[time].record;
    return std::tuple(std::string_view(file.path), file.version, record, file.times[record]);
  };
  for (std::size_t old = 0; held.storm != nullptr && old < held.numbers.size(); ++old) {
    old_times[key_of(*held.storm, old)] = old;
  }
  for (std::size_t time = 0; found.has_value() && time < found->sources.size(); ++time) {
    const auto old = old_times.find(key_of(*found, time));
    numbers.push_back(old == old_times.end() ? held.next_number++ : held.numbers[old->second]);
    kept.insert(numbers.back());
  }
  for (const int number : held.numbers) {
    if (kept.contains(number)) continue;
    cache_.Remove({place, number});
    std::erase(wanted_, TimeKey{place, number});
  }
  // If the file from which the grid was chosen has been written anew, its levels may differ, so the
  // grid is chosen again.
  const auto is_first = [&](const storm_files::StormFile& file) {
    return file.path == held.grid->path && file.version != held.grid->version;
  };
  if (held.grid.has_value() && found.has_value() && std::ranges::any_of(found->files, is_first)) {
    held.grid.reset();
  }
  held.numbers = std::move(numbers);
  held.storm =
      found.has_value() ? std::make_shared<const CataloguedStorm>(*std::move(found)) : nullptr;
  if (held.storm == nullptr) {
    ReleaseIds(place);
    return change;
  }
  TakeId(place);
  change.after = held.Info();
  return change;
}

std::string CachedStormStore::NewId(const CataloguedStorm& found, std::size_t place) {
  std::string id = earlier_ids_.Of(found).value_or(found.info.id);
  const auto is_taken = [&] {
    const auto owner = owners_.find(id);
    return owner != owners_.end() && owner->second != place;
  };
  while (is_taken()) {
    const int copy = ++copies_[found.stem];
    id = copy == 1 ? found.stem : absl::StrCat(found.stem, "-", copy);
  }
  return id;
}

void CachedStormStore::KeepIds() {
  if (options_.live->keep_ids == nullptr) return;
  StormIds ids;
  {
    const Lock lock(mutex_);
    for (const std::size_t place : order_) {
      const Held& held = storms_[place];
      if (!held.added) ids.Set(*held.storm, held.storm->info.id);
    }
    ids.AddEarlier(earlier_ids_, [this](const std::string& id) { return !owners_.contains(id); });
  }
  if (ids == kept_ids_) return;
  options_.live->keep_ids(ids.ToText());
  kept_ids_ = std::move(ids);
}

void CachedStormStore::TakeId(std::size_t place) {
  const std::string& id = storms_[place].storm->info.id;
  if (owners_.emplace(id, place).second) storms_[place].ids.push_back(id);
}

void CachedStormStore::ReleaseIds(std::size_t place) {
  for (const std::string& id : storms_[place].ids) owners_.erase(id);
  storms_[place].ids.clear();
}

}  // namespace thunderhead::storm_store
