#include "storm_store/storm_store.h"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "base/slow_calls.h"
#include "base/status.h"
#include "spdlog/spdlog.h"
#include "storm_store/cached_storm_store.h"
#include "storm_store/catalogue_scan.h"
#include "storm_store/storm_catalogue.h"

namespace thunderhead::storm_store {

std::string DomainOf(const StormInfo& storm) {
  std::string domain = absl::StrFormat("%d %d %.1f %.1f", storm.file_cells.x, storm.file_cells.y,
                                       storm.dx_m, storm.dy_m);
  // Five decimals of a degree are precise to about a metre.
  for (const std::optional<double>& degrees : {storm.latitude_deg, storm.longitude_deg}) {
    if (degrees.has_value()) absl::StrAppendFormat(&domain, " %.5f", *degrees);
  }
  return domain;
}

std::optional<volume::MapProjection> ProjectionOf(const StormInfo& storm, std::size_t time_index) {
  const std::optional<volume::EarthPlace> middle = MiddleOf(storm, time_index);
  const std::string& text = ProjectionTextOf(storm, time_index);
  if (text.empty() || !middle.has_value()) return std::nullopt;
  auto projection = volume::MapProjection::Of(text, *middle);
  if (!projection.ok()) return std::nullopt;
  return *std::move(projection);
}

double TrueNorthOf_deg(const StormInfo& storm, std::size_t time_index) {
  const bool own =
      time_index < storm.times.size() && (storm.times[time_index].middle.has_value() ||
                                          storm.times[time_index].projection.has_value());
  if (!own) return storm.true_north_deg;
  const std::optional<volume::MapProjection> projection = ProjectionOf(storm, time_index);
  if (!projection.has_value()) return 0.0;
  return projection->TrueNorth_deg(*MiddleOf(storm, time_index)).value_or(0.0);
}

namespace {

// Checks the paths. A missing path is an error, because it is probably mistyped. A named file of
// unknown format is an error, too.
absl::Status CheckPaths(const std::vector<std::string>& paths,
                        const storm_files::StormFormats& formats) {
  for (const std::string& path : paths) {
    std::error_code error;
    const auto is_folder = [&] {
      const base::SlowCall call(path);
      if (!std::filesystem::is_directory(path, error)) return false;
      const std::filesystem::directory_iterator listed(path, error);
      return true;
    };
    if (!is_folder()) {
      THUNDERHEAD_RETURN_IF_ERROR(CheckFile(path, formats));
    } else if (error) {
      return CannotBeListed(path, error);
    }
  }
  return absl::OkStatus();
}

// Opens the storms of the paths and follows changes there.
absl::StatusOr<std::unique_ptr<StormStore>> OpenLive(const std::vector<std::string>& paths,
                                                     const StormStoreOptions& options) {
  const auto store = std::make_shared<CachedStormStore>(std::vector<CataloguedStorm>{}, options);
  THUNDERHEAD_RETURN_IF_ERROR(CheckPaths(paths, options.formats));
  auto scan = std::make_unique<CatalogueScan>(
      CatalogueScan::Options{.paths = paths,
                             .formats = options.formats,
                             .links = options.links,
                             .settle = options.live->settle,
                             .retry = options.live->rescan,
                             .before_file =
                                 [weak = std::weak_ptr(store)] {
                                   if (const auto held = weak.lock()) held->LetReadersGoFirst();
                                 },
                             .time = options.time});
  store->Follow(std::move(scan));
  if (store->AwaitFirstSearch() && store->Storms().empty()) {
    spdlog::warn("{}: holds no storm yet; model output ({}) is shown as soon as it is complete",
                 absl::StrJoin(paths, ", "), options.formats.Examples());
  }
  return CachedStormStore::Owned(store);
}

}  // namespace

absl::StatusOr<std::unique_ptr<StormStore>> StormStore::Open(const std::vector<std::string>& paths,
                                                             const StormStoreOptions& options) {
  if (options.live.has_value()) return OpenLive(paths, options);
  THUNDERHEAD_ASSIGN_OR_RETURN(std::vector<CataloguedStorm> storms,
                               FindStorms(paths, options.formats, options.links, options.stop));
  return CachedStormStore::Owned(std::make_shared<CachedStormStore>(std::move(storms), options));
}

StormInfoPtr StormStore::Find(std::string_view id) const {
  const std::vector<StormInfoPtr> storms = Storms();
  const auto at = std::ranges::find(
      storms, id, [](const StormInfoPtr& storm) { return std::string_view(storm->id); });
  return at == storms.end() ? nullptr : *at;
}

}  // namespace thunderhead::storm_store
