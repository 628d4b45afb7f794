#include "service/messages/picture_texts.h"

#include <google/protobuf/util/json_util.h>

#include <cmath>
#include <string>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/version.h"

namespace thunderhead::service {

PictureTexts TextsOf(const v1::RenderImageResponse& picture, const storm_store::StormInfo& storm) {
  std::string scene;
  (void)google::protobuf::util::MessageToJsonString(picture.scene(), &scene);
  PictureTexts texts = {{"Software", absl::StrCat("Thunderhead ", base::Version())},
                        {"Title", storm.title},
                        {kSceneText, scene},
                        {"thunderhead.storm", storm.id}};
  const std::size_t time_index = picture.scene().time_index();
  if (time_index < storm.times.size()) {
    texts[kValidText] = storm.times[time_index].valid_time;
  }
  if (storm.run_start.has_value()) texts[kRunText] = *storm.run_start;
  std::string view;
  (void)google::protobuf::util::MessageToJsonString(picture.view(), &view);
  texts[kViewText] = view;
  if (!picture.view().parallel()) {
    // The length of the vector `right` is half the width of the view at distance 1. The focal
    // length in pixels is therefore half the picture's width in pixels divided by this length.
    const v1::Vector& right = picture.view().right();
    const double half_width = std::hypot(right.x(), right.y(), right.z());
    texts["thunderhead.focal_length_px"] =
        absl::StrCat(0.5 * picture.scene().output().width_px() / half_width);
  }
  if (const std::string& projection = storm_store::ProjectionTextOf(storm, time_index);
      !projection.empty()) {
    texts[kProjectionText] = projection;
    const volume::EarthPlace middle =
        storm_store::MiddleOf(storm, time_index).value_or(volume::EarthPlace());
    texts[kMiddleText] = absl::StrFormat("%.7f %.7f", middle.latitude_deg, middle.longitude_deg);
    texts[kTrueNorthText] =
        absl::StrFormat("%.7f", storm_store::TrueNorthOf_deg(storm, time_index));
  }
  if (picture.has_accuracy()) {
    texts[kErrorText] = absl::StrCat(picture.accuracy().estimated_error());
    if (picture.accuracy().measured()) {
      texts[kErrorLowText] = absl::StrCat(picture.accuracy().error_low());
      texts[kErrorHighText] = absl::StrCat(picture.accuracy().error_high());
    }
  }
  return texts;
}

}  // namespace thunderhead::service
