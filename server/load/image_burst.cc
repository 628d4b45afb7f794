#include "load/image_burst.h"

#include <string>

#include "absl/strings/str_cat.h"
#include "thunderhead/v1/thunderhead.pb.h"

namespace thunderhead::load {

void ImageBurst::Begin() {
  for (int i = 0; i < options_.count; ++i) threads_.emplace_back([this, i] { Ask(i); });
}

void ImageBurst::Join() {
  for (std::thread& thread : threads_) thread.join();
  threads_.clear();
}

void ImageBurst::Ask(int index) {
  v1::RenderImageRequest request;
  v1::Scene& scene = *request.mutable_scene();
  scene.mutable_output()->set_width_px(static_cast<std::uint32_t>(options_.width_px));
  scene.mutable_output()->set_height_px(static_cast<std::uint32_t>(options_.height_px));
  scene.mutable_camera()->mutable_orbit()->set_azimuth_deg(360.0F * static_cast<float>(index) /
                                                           static_cast<float>(options_.count));
  v1::LightVolume& light_volume = *scene.mutable_rendering()->mutable_light_volume();
  light_volume.set_traced_light(v1::TRACED_LIGHT_OFF);
  if (options_.slices > 0) light_volume.set_slices(static_cast<std::uint32_t>(options_.slices));
  request.set_format(v1::IMAGE_FORMAT_JPEG);
  const double asked_s = Now_s();
  const auto answer =
      transport_.Call("RenderImage", request.SerializeAsString(), {options_.patience_s, stop_});
  if (answer.ok()) {
    const std::lock_guard lock(mutex_);
    came_ms_.push_back(1e3 * (Now_s() - asked_s));
  } else if (!stop_.stop_requested()) {
    errors_.Add(absl::StrCat("a picture: ", answer.status().ToString()));
  }
}

}  // namespace thunderhead::load
