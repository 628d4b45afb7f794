#include "session/video_encoders.h"

#include <cstddef>
#include <utility>

#include "base/status.h"

namespace thunderhead::session {

absl::StatusOr<codec::Vp9Picture> VideoEncoders::Encode(const frame::RgbImage& picture,
                                                        VideoOrder* order) {
  const std::lock_guard lock(mutex_);
  auto& encoder = encoders_[static_cast<std::size_t>(order->tier)];
  const bool fits = encoder != nullptr && encoder->width_px() == picture.width_px &&
                    encoder->height_px() == picture.height_px;
  if (!fits) {
    THUNDERHEAD_ASSIGN_OR_RETURN(encoder,
                                 codec::Vp9Encoder::Create(picture.width_px, picture.height_px));
  }
  auto encoded = encoder->Encode(picture, order->kind);
  // The encoder's references may not be those that viewers have.
  if (!encoded.ok()) encoder = nullptr;
  if (encoded.ok() && encoded->key) order->kind = codec::Vp9Kind::kKey;
  return encoded;
}

void VideoEncoders::Release() {
  const std::lock_guard lock(mutex_);
  for (auto& encoder : encoders_) encoder = nullptr;
}

}  // namespace thunderhead::session
