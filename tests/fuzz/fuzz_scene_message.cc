// Fuzzes the bytes of scenes and Interact requests: they are parsed, checked against the limits,
// completed, and converted to the view that is drawn.
#include <algorithm>
#include <cstdint>

#include "absl/strings/string_view.h"
#include "google/protobuf/stubs/logging.h"
#include "google/protobuf/util/field_mask_util.h"
#include "service/interact/interact_requests.h"
#include "tests/fuzz/scene_path.h"

namespace thunderhead::fuzz {
namespace {

using google::protobuf::util::FieldMaskUtil;

void TakeUpdate(const v1::SceneUpdate& update) {
  const auto& paths = update.update_mask().paths();
  const bool known = std::ranges::all_of(
      paths, [](const std::string& path) { return FieldMaskUtil::IsValidPath<v1::Scene>(path); });
  if (!known) return;
  v1::Scene scene;
  FieldMaskUtil::MergeOptions options;
  options.set_replace_message_fields(true);
  options.set_replace_repeated_fields(true);
  FieldMaskUtil::MergeMessageTo(update.scene(), update.update_mask(), options, &scene);
  TakeScene(scene);
}

void TakeRequest(const v1::InteractRequest& request) {
  if (!service::CheckLimits(request).ok()) return;
  if (request.has_join()) static_cast<void>(service::NameOf(request.join().name(), "join.name"));
  if (request.has_update_scene()) TakeUpdate(request.update_scene());
  if (request.has_set_rules()) service::RulesOf(request.set_rules().rules(), {});
  if (request.has_point()) static_cast<void>(service::RayOf(request.point().ray(), "point.ray"));
}

}  // namespace
}  // namespace thunderhead::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  namespace v1 = thunderhead::v1;
  // Protobuf would log a line for each text that is not UTF-8.
  [[maybe_unused]] static const auto quiet = google::protobuf::SetLogHandler(nullptr);
  if (size == 0) return 0;
  const int bytes = static_cast<int>(size - 1);
  v1::Scene scene;
  v1::InteractRequest request;
  if (data[0] % 2 == 0) {
    if (scene.ParseFromArray(data + 1, bytes)) thunderhead::fuzz::TakeScene(scene);
  } else if (request.ParseFromArray(data + 1, bytes)) {
    thunderhead::fuzz::TakeRequest(request);
  }
  return 0;
}
