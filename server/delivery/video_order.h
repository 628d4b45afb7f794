// Decides which pictures of a video stream are encoded and which kinds they have, and records one
// viewer's place in the stream. A video picture can be decoded only after its base picture, so a
// viewer that missed a base picture waits for a key picture. Plain values; the time is an argument.
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

// A picture of a stream. It is identified by the sequence number of its frame.
struct VideoPicture {
  std::shared_ptr<const EncodedFrame> frame;
  std::uint64_t needs = 0;  // sequence of the base picture that it needs; 0 for a key picture
  bool is_base = false;     // later pictures need it
};

// One viewer's place in a stream.
class VideoPlace {
 public:
  using Time = std::chrono::steady_clock::time_point;

  // A viewer that lost the stream waits this long for its next key picture. The wait doubles with
  // each loss that comes within kSound of joining the stream, because key pictures cost all viewers
  // bandwidth.
  static constexpr std::chrono::seconds kShortestWait{2};
  static constexpr std::chrono::seconds kLongestWait{64};
  static constexpr std::chrono::seconds kSound{30};

  // Moves the viewer to the stream of that tier.
  void Enter(int tier);
  // Returns the sequence of the base picture that the viewer has in the stream of `tier`; 0 if it
  // has none.
  std::uint64_t BaseOf(int tier) const { return tier == tier_ ? base_ : 0; }
  bool CanTake(int tier, const VideoPicture& picture) const {
    return picture.needs == 0 || picture.needs == BaseOf(tier);
  }
  void Took(std::uint64_t sequence, const VideoPicture& picture, Time now);

  // Records that the viewer leaves the stream. It needs a key picture to rejoin.
  void Leave() { base_ = 0; }
  // Records that the viewer missed a base picture or could not decode one.
  void Lost(Time now);
  bool MayHaveKey(Time now) const { return now >= key_again_at_; }

 private:
  int tier_ = 0;
  std::uint64_t base_ = 0;
  Time joined_at_;  // time of the key picture by which the viewer joined
  Time key_again_at_;
  std::chrono::seconds wait_ = kShortestWait;
};

// The video stream of one tier.
class VideoStream {
 public:
  using Time = VideoPlace::Time;

  // Minimum time between key pictures that are encoded because viewers ask for them. It does not
  // apply if no viewer follows the stream.
  static constexpr std::chrono::seconds kKeyPause{1};
  // Maximum number of consecutive droppable pictures. Viewers that cannot take every picture skip
  // these.
  static constexpr int kMaxDroppable = 3;

  // A viewer of the stream at the time when a picture is drawn.
  struct Follower {
    VideoPlace* place = nullptr;
    bool is_ready = false;            // whether it can take a frame now
    std::uint64_t last_sequence = 0;  // sequence of the last frame that it has taken, in any form
  };
  // Starts collecting the stream's followers, which are then added with Ask. After that, Next
  // returns the kind of picture to encode.
  void Begin() { asked_ = Asked(); }
  void Ask(int tier, const Follower& follower, Time now);
  // Returns the kind of picture to encode, or none if no viewer could take a picture.
  std::optional<codec::Vp9Kind> Next(Time now) const;

  // Adds the picture that was encoded for the frame of that sequence.
  VideoPicture Add(std::uint64_t sequence, codec::Vp9Kind kind,
                   std::shared_ptr<const EncodedFrame> frame, Time now);

  // Returns the newest base picture, for viewers that have not taken it yet. Its frame is null
  // before the first base picture.
  const VideoPicture& NewestBase() const { return base_; }
  std::uint64_t NewestBaseSequence() const { return base_sequence_; }

 private:
  struct Asked {
    bool key = false;          // a viewer that may have a key picture needs one
    bool next = false;         // a viewer can take the picture after the newest base picture
    bool others_wait = false;  // a viewer in the stream cannot take the next picture yet
  };

  Asked asked_;
  VideoPicture base_;
  std::uint64_t base_sequence_ = 0;
  int droppable_ = 0;  // number of droppable pictures since the newest base picture
  std::optional<Time> key_at_;
};

}  // namespace thunderhead::delivery
