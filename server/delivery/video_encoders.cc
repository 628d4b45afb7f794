#include "delivery/video_encoders.h"

#include <cstddef>
#include <utility>

#include "base/status.h"

namespace thunderhead::delivery {

absl::StatusOr<codec::Vp9Picture> VideoEncoders::Encode(const frame::RgbImage& picture,
                                                        VideoOrder* order,
                                                        base::MemoryBudget& memory) {
  const std::lock_guard lock(mutex_);
  Encoder& encoder = encoders_[static_cast<std::size_t>(order->tier)];
  const bool fits = encoder.vp9 != nullptr && encoder.vp9->width_px() == picture.width_px &&
                    encoder.vp9->height_px() == picture.height_px;
  if (!fits) {
    encoder = {};
    THUNDERHEAD_ASSIGN_OR_RETURN(
        encoder.memory,
        memory.Reserve(base::MemoryUse::kPictures,
                       codec::Vp9Encoder::BytesFor(picture.width_px, picture.height_px),
                       "a stream of video"));
    THUNDERHEAD_ASSIGN_OR_RETURN(encoder.vp9,
                                 codec::Vp9Encoder::Create(picture.width_px, picture.height_px));
  }
  auto encoded = encoder.vp9->Encode(picture, order->kind);
  // The encoder is discarded after an error, because its reference pictures may then differ from
  // those that viewers have.
  if (!encoded.ok()) encoder = {};
  if (encoded.ok() && encoded->key) order->kind = codec::Vp9Kind::kKey;
  return encoded;
}

void VideoEncoders::Release() {
  const std::lock_guard lock(mutex_);
  for (Encoder& encoder : encoders_) encoder = {};
}

}  // namespace thunderhead::delivery
