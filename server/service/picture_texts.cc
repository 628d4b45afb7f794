#include "service/picture_texts.h"

#include <google/protobuf/util/json_util.h>

#include <string>

#include "absl/strings/str_cat.h"
#include "base/version.h"

namespace thunderhead::service {

frame::PngTexts TextsOf(const v1::RenderImageResponse& picture, const volume::StormInfo& storm) {
  std::string scene;
  (void)google::protobuf::util::MessageToJsonString(picture.scene(), &scene);
  frame::PngTexts texts = {{"Software", absl::StrCat("Thunderhead ", base::Version())},
                           {"Title", storm.title},
                           {kSceneText, scene},
                           {"thunderhead.storm", storm.id}};
  const std::size_t time_index = picture.scene().time_index();
  if (time_index < storm.times.size()) {
    texts["thunderhead.valid"] = storm.times[time_index].valid_time;
  }
  if (picture.has_accuracy()) {
    texts["thunderhead.estimated_error"] = absl::StrCat(picture.accuracy().estimated_error());
  }
  return texts;
}

}  // namespace thunderhead::service
