// The newest frame of a session in all the forms that its viewers take: JPEG in several sizes,
// pictures of video, and stills of higher quality, which come a little later. Safe from any thread.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>

#include "delivery/encoded_frame.h"
#include "delivery/link_estimate.h"
#include "delivery/video_order.h"

namespace thunderhead::delivery {

// Makes a frame with its picture as JPEG in a tier (link_estimate.h); none if that fails, which it
// tells by itself.
using EncodeFrame =
    std::function<std::optional<EncodedFrame>(const EncodedFrame& described, int tier)>;

// Pictures of video by their tiers; null frames where there is none.
using VideoPictures = std::array<VideoPicture, kTiers>;

// A form of a frame.
struct FrameForm {
  enum class Kind { kJpeg, kVideo, kStill };

  Kind kind = Kind::kJpeg;
  int tier = 0;

  bool operator==(const FrameForm&) const = default;
};

class PublishedFrame {
 public:
  // `described` has no picture. Without `encode` it is given for every tier. Where `still_follows`
  // there will be stills, or word that there are none.
  PublishedFrame(EncodedFrame described, EncodeFrame encode, VideoPictures video = {},
                 bool still_follows = false);

  const EncodedFrame& Described() const { return described_; }

  // Encoded when it is first wanted; null if that fails.
  std::shared_ptr<const EncodedFrame> Jpeg(int tier);

  const VideoPicture& Video(int tier) const { return video_[static_cast<std::size_t>(tier)]; }

  void SetStill(int tier, EncodedFrame still);
  std::shared_ptr<const EncodedFrame> Still(int tier) const;
  // There are no stills after all.
  void NoStills();
  bool StillFollows() const;

  // No newer frame has come for a while, so it is worth waiting for in full.
  void Rest();
  bool Rests() const;

 private:
  const EncodedFrame described_;
  const EncodeFrame encode_;
  const VideoPictures video_;
  std::mutex encoding_;  // held while a JPEG is made
  std::array<std::shared_ptr<const EncodedFrame>, kTiers> jpegs_;
  mutable std::mutex mutex_;  // of the rest
  std::array<std::shared_ptr<const EncodedFrame>, kTiers> stills_;
  bool still_follows_;
  bool rests_;
};

}  // namespace thunderhead::delivery
