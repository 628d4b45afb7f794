#include "volume/storm_store.h"

#include <algorithm>

#include "base/status.h"
#include "volume/cached_storm_store.h"
#include "volume/storm_catalogue.h"

namespace thunderhead::volume {

absl::StatusOr<std::unique_ptr<StormStore>> StormStore::Open(const std::vector<std::string>& paths,
                                                             const StormStoreOptions& options) {
  THUNDERHEAD_ASSIGN_OR_RETURN(std::vector<CataloguedStorm> storms,
                               FindStorms(paths, options.formats));
  return std::make_unique<CachedStormStore>(std::move(storms), options);
}

const StormInfo* StormStore::Find(std::string_view id) const {
  const std::vector<const StormInfo*> storms = Storms();
  const auto at = std::ranges::find(storms, id, &StormInfo::id);
  return at == storms.end() ? nullptr : *at;
}

}  // namespace thunderhead::volume
