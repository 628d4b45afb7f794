// The newest frame of a session in all forms that viewers take: JPEG in several sizes, video
// pictures, and resting frames. A resting frame is an AVIF encoding of higher quality, which is
// added a little later. Safe from any thread.
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

// Encodes a frame's picture as JPEG in a tier (link_estimate.h). Returns none on failure, after
// reporting the failure itself.
using EncodeFrame =
    std::function<std::optional<EncodedFrame>(const EncodedFrame& described, int tier)>;

// Video pictures by tier; the frame is null if a tier has no picture.
using VideoPictures = std::array<VideoPicture, kTiers>;

// An encoding and size of a frame.
struct FrameForm {
  enum class Kind { kJpeg, kVideo, kResting };

  Kind kind = Kind::kJpeg;
  int tier = 0;

  bool operator==(const FrameForm&) const = default;
};

class PublishedFrame {
 public:
  // `described` has no picture. Without `encode`, Jpeg returns `described` itself for every tier.
  // If `resting_frame_follows` is true, a call of SetRestingFrame or NoRestingFrame must follow.
  PublishedFrame(EncodedFrame described, EncodeFrame encode, VideoPictures video = {},
                 bool resting_frame_follows = false);

  const EncodedFrame& Described() const { return described_; }

  // Returns the frame as JPEG, encoded when it is first used. Returns null if the encoding fails.
  std::shared_ptr<const EncodedFrame> Jpeg(int tier);

  const VideoPicture& Video(int tier) const { return video_[static_cast<std::size_t>(tier)]; }

  void SetRestingFrame(int tier, EncodedFrame resting_frame);
  std::shared_ptr<const EncodedFrame> RestingFrame(int tier) const;
  // Records that the frame gets no resting frame although one was announced.
  void NoRestingFrame();
  bool RestingFrameFollows() const;

  // Records that no newer frame has come for a while, so that viewers get this frame in full
  // quality.
  void Rest();
  bool Rests() const;

 private:
  const EncodedFrame described_;
  const EncodeFrame encode_;
  const VideoPictures video_;
  std::mutex encoding_;  // held while a JPEG is encoded
  std::array<std::shared_ptr<const EncodedFrame>, kTiers> jpegs_;
  mutable std::mutex mutex_;  // guards the members below
  std::array<std::shared_ptr<const EncodedFrame>, kTiers> resting_frames_;
  bool resting_frame_follows_;
  bool rests_;
};

}  // namespace thunderhead::delivery
