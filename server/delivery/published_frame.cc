#include "delivery/published_frame.h"

#include <cstddef>
#include <utility>

namespace thunderhead::delivery {

PublishedFrame::PublishedFrame(EncodedFrame described, EncodeFrame encode, VideoPictures video,
                               bool still_follows)
    : described_(std::move(described)),
      encode_(std::move(encode)),
      video_(std::move(video)),
      still_follows_(still_follows),
      rests_(described_.at_rest) {}

std::shared_ptr<const EncodedFrame> PublishedFrame::Jpeg(int tier) {
  const std::lock_guard lock(encoding_);
  auto& frame = jpegs_[static_cast<std::size_t>(tier)];
  if (frame != nullptr) return frame;
  std::optional<EncodedFrame> encoded = encode_ == nullptr ? described_ : encode_(described_, tier);
  if (encoded.has_value()) frame = std::make_shared<const EncodedFrame>(*std::move(encoded));
  return frame;
}

void PublishedFrame::SetStill(int tier, EncodedFrame still) {
  const std::lock_guard lock(mutex_);
  stills_[static_cast<std::size_t>(tier)] = std::make_shared<const EncodedFrame>(std::move(still));
}

std::shared_ptr<const EncodedFrame> PublishedFrame::Still(int tier) const {
  const std::lock_guard lock(mutex_);
  return stills_[static_cast<std::size_t>(tier)];
}

void PublishedFrame::NoStills() {
  const std::lock_guard lock(mutex_);
  still_follows_ = false;
}

bool PublishedFrame::StillFollows() const {
  const std::lock_guard lock(mutex_);
  return still_follows_;
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
