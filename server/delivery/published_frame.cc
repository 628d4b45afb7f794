#include "delivery/published_frame.h"

#include <cstddef>
#include <utility>

namespace thunderhead::delivery {

PublishedFrame::PublishedFrame(EncodedFrame described, EncodeFrame encode, VideoPictures video,
                               bool resting_frame_follows)
    : described_(std::move(described)),
      encode_(std::move(encode)),
      video_(std::move(video)),
      resting_frame_follows_(resting_frame_follows),
      rests_(described_.at_rest) {}

std::shared_ptr<const EncodedFrame> PublishedFrame::Jpeg(int tier) {
  const std::lock_guard lock(encoding_);
  auto& frame = jpegs_[static_cast<std::size_t>(tier)];
  if (frame != nullptr) return frame;
  std::optional<EncodedFrame> encoded = encode_ == nullptr ? described_ : encode_(described_, tier);
  if (encoded.has_value()) frame = std::make_shared<const EncodedFrame>(*std::move(encoded));
  return frame;
}

void PublishedFrame::SetRestingFrame(int tier, EncodedFrame resting_frame) {
  const std::lock_guard lock(mutex_);
  resting_frames_[static_cast<std::size_t>(tier)] =
      std::make_shared<const EncodedFrame>(std::move(resting_frame));
}

std::shared_ptr<const EncodedFrame> PublishedFrame::RestingFrame(int tier) const {
  const std::lock_guard lock(mutex_);
  return resting_frames_[static_cast<std::size_t>(tier)];
}

void PublishedFrame::NoRestingFrame() {
  const std::lock_guard lock(mutex_);
  resting_frame_follows_ = false;
}

bool PublishedFrame::RestingFrameFollows() const {
  const std::lock_guard lock(mutex_);
  return resting_frame_follows_;
}

void PublishedFrame::Rest() {
  const std::lock_guard lock(mutex_);
  rests_ = true;
}

bool PublishedFrame::Rests() const {
  const std::lock_guard lock(mutex_);
  return rests_;
}

}  // namespace thunderhead::delivery
