// Makes stills (AVIF pictures of higher quality) of frames that have come to rest. Stills are
// encoded on a separate thread with low priority, so that frames of changing scenes need not wait
// for them. A newer frame of a session drops the pending still of the older frame. A still that is
// already being encoded, which takes about a tenth of a second, is completed.
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

// A published frame of which a still may be made.
struct StillToMake {
  std::weak_ptr<session::Session> session;
  std::uint64_t sequence = 0;
  delivery::EncodedFrame described;  // without a picture
  session::Clock::time_point rests_at;
  // Null if no viewer takes stills of higher quality.
  std::shared_ptr<delivery::PictureSizes<frame::FineImage>> fine;
};

class StillMaker {
 public:
  // A frame that was drawn while the scene changed counts as at rest this long after Make, or at
  // StillToMake::rests_at if that is later. A newer frame cancels this.
  static constexpr std::chrono::milliseconds kRestsAfter{150};

  explicit StillMaker(SerializeFrame serialize, const base::TimeSource& time = base::SteadyTime());
  // Waits for the still that is being encoded and drops the others.
  ~StillMaker();
  StillMaker(const StillMaker&) = delete;
  StillMaker& operator=(const StillMaker&) = delete;

  void Make(StillToMake still);

 private:
  using Time = session::Clock::time_point;
  struct Waiting {
    StillToMake still;
    Time due;
  };

  void Run();
  absl::StatusOr<delivery::EncodedFrame> Encoded(const StillToMake& still, int tier) const;
  void MakeNow(const StillToMake& still) const;

  const SerializeFrame serialize_;
  const base::TimeSource& time_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool stopping_ = false;
  std::map<const session::Session*, Waiting> waiting_;  // newest frame of each session
  std::thread thread_;
};

}  // namespace thunderhead::drawing
