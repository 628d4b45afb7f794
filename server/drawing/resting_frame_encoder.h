// Encodes frames that have come to rest as resting frames (AVIF of higher quality). This happens on
// a separate thread with low priority, so that frames of changing scenes need not wait for it. A
// newer frame of a session drops the pending resting frame of the older frame. One that is already
// being encoded, which takes about a tenth of a second, is completed.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <thread>

#include "base/time_source.h"
#include "delivery/encoded_frame.h"
#include "delivery/picture_sizes.h"
#include "frame/fine_image.h"
#include "session/sessions.h"

namespace thunderhead::drawing {

// Serializes a frame into the bytes that all viewers are sent.
using SerializeFrame = std::function<std::string(const delivery::EncodedFrame&)>;

// A published frame that may be encoded as a resting frame.
struct RestingFrame {
  std::weak_ptr<session::Session> session;
  std::uint64_t sequence = 0;
  delivery::EncodedFrame described;  // without a picture
  session::Clock::time_point rests_at;
  // Null if no viewer takes resting frames.
  std::shared_ptr<delivery::PictureSizes<frame::FineImage>> fine;
};

class RestingFrameEncoder {
 public:
  // A frame that was drawn while the scene changed counts as at rest this long after Encode, or at
  // RestingFrame::rests_at if that is later. A newer frame cancels this.
  static constexpr std::chrono::milliseconds kRestsAfter{150};

  explicit RestingFrameEncoder(SerializeFrame serialize,
                               const base::TimeSource& time = base::SteadyTime());
  // Waits for the resting frame that is being encoded and drops the others.
  ~RestingFrameEncoder();
  RestingFrameEncoder(const RestingFrameEncoder&) = delete;
  RestingFrameEncoder& operator=(const RestingFrameEncoder&) = delete;

  void Encode(RestingFrame resting);

 private:
  using Time = session::Clock::time_point;
  struct Waiting {
    RestingFrame resting;
    Time due;
  };

  void Run();
  absl::StatusOr<delivery::EncodedFrame> Encoded(const RestingFrame& resting, int tier) const;
  void EncodeNow(const RestingFrame& resting) const;

  const SerializeFrame serialize_;
  const base::TimeSource& time_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool stopping_ = false;
  std::map<const session::Session*, Waiting> waiting_;  // newest frame of each session
  std::thread thread_;
};

}  // namespace thunderhead::drawing
