#include "delivery/video_order.h"

#include <algorithm>
#include <utility>

namespace thunderhead::delivery {

void VideoPlace::Enter(int tier) {
  if (tier == tier_) return;
  tier_ = tier;
  base_ = 0;
}

void VideoPlace::Took(std::uint64_t sequence, const VideoPicture& picture, Time now) {
  if (!picture.is_base) return;
  if (picture.needs == 0) joined_at_ = now;
  base_ = sequence;
}

void VideoPlace::Lost(Time now) {
  if (base_ == 0) return;
  wait_ = now - joined_at_ >= kSound ? kShortestWait : std::min(2 * wait_, kLongestWait);
  key_again_at_ = now + wait_;
  base_ = 0;
}

void VideoStream::Ask(int tier, const Follower& follower, Time now) {
  VideoPlace& place = *follower.place;
  place.Enter(tier);
  const std::uint64_t has = place.BaseOf(tier);
  const bool in_sequence = has != 0 && has == base_sequence_;
  // The viewer can still take the newest base picture and then the next one.
  const bool catches_up = has != 0 && base_sequence_ > follower.last_sequence &&
                          (base_.needs == 0 || base_.needs == has);
  if (has != 0 && !in_sequence && !catches_up) place.Lost(now);
  if (in_sequence && follower.is_ready) {
    asked_.next = true;
  } else if (in_sequence || catches_up) {
    asked_.others_wait = true;
  } else if (follower.is_ready && place.MayHaveKey(now)) {
    asked_.key = true;
  }
}

std::optional<codec::Vp9Kind> VideoStream::Next(Time now) const {
  const bool nobody_follows = !asked_.next && !asked_.others_wait;
  if (asked_.key && (nobody_follows || !key_at_.has_value() || now >= *key_at_ + kKeyPause)) {
    return codec::Vp9Kind::kKey;
  }
  if (!asked_.next) return std::nullopt;
  const bool droppable = asked_.others_wait && droppable_ < kMaxDroppable;
  return droppable ? codec::Vp9Kind::kDroppable : codec::Vp9Kind::kBase;
}

VideoPicture VideoStream::Add(std::uint64_t sequence, codec::Vp9Kind kind,
                              std::shared_ptr<const EncodedFrame> frame, Time now) {
  const std::uint64_t needs = kind == codec::Vp9Kind::kKey ? 0 : base_sequence_;
  VideoPicture picture{std::move(frame), needs, kind != codec::Vp9Kind::kDroppable};
  if (kind == codec::Vp9Kind::kKey) key_at_ = now;
  if (picture.is_base) {
    base_ = picture;
    base_sequence_ = sequence;
    droppable_ = 0;
  } else {
    ++droppable_;
  }
  return picture;
}

}  // namespace thunderhead::delivery
