#include "service/messages/prepare_scene.h"

#include <algorithm>
#include <chrono>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "base/error_details.h"
#include "base/status.h"
#include "service/messages/scene_messages.h"
#include "service/messages/technique_messages.h"

namespace thunderhead::service {
namespace {

// Maximum number of storms that an error message lists, because there may be thousands. This number
// is enough to recognise a typing error.
constexpr std::size_t kMaxNamesListed = 10;

std::string NamesOf(const std::vector<storm_store::StormInfoPtr>& storms) {
  const std::size_t listed = std::min(storms.size(), kMaxNamesListed);
  std::string names = absl::StrJoin(
      storms.begin(), storms.begin() + static_cast<std::ptrdiff_t>(listed), ", ",
      [](std::string* out, const storm_store::StormInfoPtr& storm) { out->append(storm->id); });
  if (listed < storms.size()) absl::StrAppend(&names, " and ", storms.size() - listed, " more");
  return names;
}

}  // namespace

absl::StatusOr<storm_store::StormInfoPtr> FindStorm(const storm_store::StormStore& store,
                                                    const std::string& id) {
  const bool searching = store.IsSearching();
  const std::vector<storm_store::StormInfoPtr> storms = store.Storms();
  const auto at = std::ranges::find(storms, id, [](const auto& storm) { return storm->id; });
  if (at != storms.end()) return *at;
  if (id.empty() && !storms.empty()) return storms.front();
  if (searching) {
    return base::WithDetails(
        absl::UnavailableError(
            "the server has just started and still searches its folders for storms; try again"),
        {.reason = "SEARCHING_STORMS", .retry_after = std::chrono::seconds(2)});
  }
  if (storms.empty()) {
    return base::WithDetails(
        absl::NotFoundError("the server has no storms; ask its operator to add a storm folder"),
        {.reason = kStormNotFound});
  }
  return base::WithDetails(absl::NotFoundError(absl::StrCat("no storm has the id '", id,
                                                            "'; the server has ", NamesOf(storms))),
                           {.reason = kStormNotFound, .metadata = {{"storm_id", id}}});
}

absl::Status CheckTime(const storm_store::StormInfo& storm, std::uint32_t time_index,
                       const std::string& path) {
  if (time_index < storm.times.size()) return absl::OkStatus();
  const std::size_t last = storm.times.size() - 1;
  return base::InvalidField(
      path, absl::StrCat("is ", time_index, "; storm '", storm.id, "' has times 0 to ", last),
      "VALUE_OUT_OF_RANGE", {{"minimum", "0"}, {"maximum", absl::StrCat(last)}});
}

absl::Status PrepareScene(const storm_store::StormStore& store,
                          const std::vector<scene::TechniqueInfo>& techniques, v1::Scene& scene) {
  // Unknown fields are removed, because they would be stored and sent to every viewer.
  scene.DiscardUnknownFields();
  THUNDERHEAD_RETURN_IF_ERROR(CheckScene(scene));
  THUNDERHEAD_RETURN_IF_ERROR(CheckRendering(scene.rendering(), techniques));
  THUNDERHEAD_ASSIGN_OR_RETURN(const storm_store::StormInfoPtr storm,
                               FindStorm(store, scene.storm_id()));
  if (!scene.has_time_index()) {
    scene.set_time_index(static_cast<std::uint32_t>(storm->times.size() - 1));
  }
  THUNDERHEAD_RETURN_IF_ERROR(CheckTime(*storm, scene.time_index(), "scene.time_index"));
  FillSceneDefaults(scene, *storm);
  return absl::OkStatus();
}

}  // namespace thunderhead::service
