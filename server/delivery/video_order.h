// The order of a stream's pictures, and one viewer's place in it. A picture of video needs the base
// picture before it, so a viewer that missed one waits for a key picture. Plain values that are
// told the time.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>

#include "codec/vp9.h"

namespace thunderhead::delivery {

struct EncodedFrame;

// A picture to be encoded for the stream of a tier.
struct VideoOrder {
  int tier = 0;
  codec::Vp9Kind kind = codec::Vp9Kind::kKey;
};

// A picture of a stream. Pictures are named by their frames' sequences.
struct VideoPicture {
  std::shared_ptr<const EncodedFrame> frame;
  std::uint64_t needs = 0;  // the base picture that it needs; 0 for a key picture
  bool is_base = false;     // the next ones need it
};

// One viewer's place.
class VideoPlace {
 public:
  using Time = std::chrono::steady_clock::time_point;

  // A viewer who lost the stream waits so long for its next key picture, longer with each loss
  // of it within kSound: key pictures cost everybody bytes.
  static constexpr std::chrono::seconds kShortestWait{2};
  static constexpr std::chrono::seconds kLongestWait{64};
  static constexpr std::chrono::seconds kSound{30};

  // Its pictures are those of that tier from now on.
  void Enter(int tier);
  // The base picture of `tier` that it has; 0: none.
  std::uint64_t BaseOf(int tier) const { return tier == tier_ ? base_ : 0; }
  bool CanTake(int tier, const VideoPicture& picture) const {
    return picture.needs == 0 || picture.needs == BaseOf(tier);
  }
  void Took(std::uint64_t sequence, const VideoPicture& picture, Time now);

  // It gets other pictures than the stream's from now on, and joins it anew when it comes back.
  void Leave() { base_ = 0; }
  // It missed a base picture, or could not decode one.
  void Lost(Time now);
  bool MayHaveKey(Time now) const { return now >= key_again_at_; }

 private:
  int tier_ = 0;
  std::uint64_t base_ = 0;
  Time joined_at_;  // the stream, by a key picture
  Time key_again_at_;
  std::chrono::seconds wait_ = kShortestWait;
};

// A stream of one tier.
class VideoStream {
 public:
  using Time = VideoPlace::Time;

  // The least time between key pictures that viewers ask for.
  static constexpr std::chrono::seconds kKeyPause{1};
  // Pictures in a row that no other needs, for viewers who cannot take all.
  static constexpr int kMaxDroppable = 3;

  // A viewer of the stream, when a picture is drawn.
  struct Follower {
    VideoPlace* place = nullptr;
    bool is_ready = false;            // to take a frame
    std::uint64_t last_sequence = 0;  // of the frames that it has taken, in whatever form
  };
  // Collects the stream's followers; then Next tells the picture to encode.
  void Begin() { asked_ = Asked(); }
  void Ask(int tier, const Follower& follower, Time now);
  // None if nobody could take it.
  std::optional<codec::Vp9Kind> Next(Time now) const;

  // The picture was encoded for the frame of that sequence.
  VideoPicture Add(std::uint64_t sequence, codec::Vp9Kind kind,
                   std::shared_ptr<const EncodedFrame> frame, Time now);

  // The newest base picture, for those who have not taken it yet; null frame before the first.
  const VideoPicture& NewestBase() const { return base_; }
  std::uint64_t NewestBaseSequence() const { return base_sequence_; }

 private:
  struct Asked {
    bool key = false;          // by one who may have it
    bool next = false;         // by one who can take what follows the newest base picture
    bool others_wait = false;  // one of those is not ready
  };

  Asked asked_;
  VideoPicture base_;
  std::uint64_t base_sequence_ = 0;
  int droppable_ = 0;  // since the newest base picture
  std::optional<Time> key_at_;
};

}  // namespace thunderhead::delivery
