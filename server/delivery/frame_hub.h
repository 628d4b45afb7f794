// Distributes a session's newest frame to its viewers. Each viewer has at most two unacknowledged
// JPEG frames, or two to eight unacknowledged video frames. A slow viewer skips frames and never
// slows another viewer. A viewer with a slow link gets video if its client can decode video, or
// else smaller pictures. Each form (encoding and size) of a frame is encoded once for all viewers.
// The hub keeps only the newest frame, the newest problem and the newest base picture of each video
// stream. Safe from any thread. Does not know how frames are drawn, encoded or sent.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <random>
#include <variant>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "base/time_source.h"
#include "delivery/encoded_frame.h"
#include "delivery/flight_window.h"
#include "delivery/link_estimate.h"
#include "delivery/published_frame.h"
#include "delivery/video_order.h"

namespace thunderhead::delivery {

using FrameEvent = std::variant<std::shared_ptr<const EncodedFrame>, Problem>;

// A viewer's settings for the frames that it receives.
struct ViewerWants {
  int window_width_px = 0;            // 0 means the width that the scene asks for
  double frames_per_second = 0.0;     // maximum rate; 0 means no limit
  bool adapts = false;                // accepts smaller pictures on a slow link
  bool takes_video = false;           // accepts VP9 video; has an effect only if `adapts` is set
  bool takes_resting_frames = false;  // accepts resting frames (AVIF of higher quality)
  bool saves_bytes = false;           // prefers video even on a fast link

  bool operator==(const ViewerWants&) const = default;
};

// A viewer of the session. The hub calls Wake when Take may return something, or when the hub has
// closed. It calls Wake from any thread, without holding its lock.
class Viewer {
 public:
  virtual ~Viewer() = default;
  virtual void Wake() = 0;
};

// A picture that was encoded for a video stream.
struct EncodedVideo {
  VideoOrder order;  // its kind may be kKey although another kind was ordered
  EncodedFrame frame;
};

inline PictureWidth WidthOf(const EncodedFrame& frame) {
  return {frame.width_px, std::max(frame.full_width_px, frame.width_px)};
}

class FrameHub {
 public:
  using Time = std::chrono::steady_clock::time_point;

  // Maximum number of unacknowledged JPEG frames per viewer. Video uses FlightWindow.
  static constexpr std::size_t kMaxInFlight = 2;
  // If at least this many viewers can decode video, all of these get video. One video encoding then
  // costs less than sending JPEG to each of them.
  static constexpr int kManyForVideo = 12;
  // Maximum time that a viewer that has a resting frame keeps it while waiting for the next one of
  // the same scene.
  static constexpr std::chrono::seconds kLongestForRestingFrame{2};

  // Both callbacks are called without the lock. The hub calls `on_demand` when a viewer joins,
  // leaves or becomes ready for another frame. It calls `on_wait` when a caller must call
  // WakeWaiting soon. `time` must outlive the hub. Functions use its current time if their argument
  // `at` is absent.
  explicit FrameHub(
      std::function<void()> on_demand, std::function<void()> on_wait = [] {},
      const base::TimeSource& time = base::SteadyTime());

  // Adds a viewer and returns its id. Returns the reason given to Close if the hub is closed. Does
  // not call Wake.
  absl::StatusOr<std::uint64_t> Join(std::shared_ptr<Viewer> viewer, const ViewerWants& wants = {});
  void SetWants(std::uint64_t viewer_id, const ViewerWants& wants);
  void Leave(std::uint64_t viewer_id);

  // Returns the newest frame or problem that the viewer has not received yet. Returns none while
  // too many of the viewer's frames are in flight (taken but not acknowledged), or while the
  // viewer's maximum frame rate does not allow another frame. A frame that cannot be encoded is not
  // in flight.
  std::optional<FrameEvent> Take(std::uint64_t viewer_id, std::optional<Time> at = std::nullopt);

  // Acknowledges all frames up to `sequence`. Wakes the viewer only if it can now take something.
  // Calls `on_demand` only if the viewer could not take a frame before. Returns false if the viewer
  // does not exist.
  bool Acknowledge(std::uint64_t viewer_id, std::uint64_t sequence,
                   std::optional<Time> at = std::nullopt);

  // Records that the viewer could not decode its video. The viewer gets JPEG until the next key
  // picture.
  void LoseVideo(std::uint64_t viewer_id, std::optional<Time> at = std::nullopt);

  // Wakes the viewers with a limited frame rate whose next frame is due. Returns when the next of
  // these viewers is due.
  std::optional<Time> WakeWaiting(Time now);

  // Returns orders for the video pictures that must be encoded before the frame is published.
  // Viewers get a frame at rest as JPEG. If a resting frame follows, viewers that take resting
  // frames get video instead, or wait if they already have a resting frame of the scene.
  std::vector<VideoOrder> OrderVideo(const EncodedFrame& described, bool resting_frame_follows,
                                     std::optional<Time> at = std::nullopt);
  // Replaces the newest frame and returns its sequence. `described` is the frame without a picture.
  // `encode` makes the JPEG of each tier (link_estimate.h) that a viewer needs.
  std::uint64_t Publish(EncodedFrame described, EncodeFrame encode = nullptr,
                        std::vector<EncodedVideo> video = {}, bool resting_frame_follows = false,
                        std::optional<Time> at = std::nullopt);
  // The next three calls have an effect only if the newest frame has that sequence. AddRestingFrame
  // adds the frame's encoding of higher quality in one tier. NoRestingFrame records that none
  // follows. Rest records that no newer frame has come for a while.
  void AddRestingFrame(std::uint64_t sequence, int tier, EncodedFrame resting_frame);
  void NoRestingFrame(std::uint64_t sequence);
  void Rest(std::uint64_t sequence);
  // Replaces the newest problem. The problem ends when a frame of the same or a newer revision is
  // published.
  void Publish(Problem problem);
  // Does the same as Publish(Problem) but wakes no viewer. It is called while a viewer takes the
  // frame that turns out to have the problem.
  void Note(Problem problem);

  // Drops the newest frame if there are no viewers. Returns true if it dropped a frame.
  bool DropUnwatched();

  // Ends all viewers' streams with `why`. Later calls do not change the reason.
  void Close(const absl::Status& why);
  // Returns OK while the hub is open.
  absl::Status ClosedBecause() const;

  bool HasViewers() const;
  std::size_t Viewers() const;
  // Returns true if a viewer can be sent another frame now.
  bool HasReadyViewer() const;
  // Returns, for each tier, whether a viewer now takes resting frames in that tier. `width` is the
  // width of the frame.
  std::array<bool, kTiers> RestingTiers(const PictureWidth& width) const;
  bool IsNewest(std::uint64_t sequence) const;

 private:
  struct Sent {
    std::uint64_t sequence = 0;
    Time at;
    bool moving = false;  // true for video, and for JPEG of a frame that is not at rest
    bool video = false;
    bool was_last = false;  // this frame filled the window, so that no further frame could be sent
    std::optional<Time> changed_at;  // set if it is the first frame of its revision that was sent
  };
  struct Watch {
    std::shared_ptr<Viewer> viewer;
    ViewerWants wants;
    LinkEstimate link;
    VideoPlace place;
    FlightWindow window;
    std::deque<Sent> in_flight;  // oldest first
    std::uint64_t last_sequence = 0;
    FrameForm last_form;
    std::optional<Time> waits_until;  // time at which its maximum frame rate allows the next frame
    std::uint64_t last_problem = 0;
    std::uint64_t last_revision = 0;
  };

  // A frame that a viewer can take, and the form in which the viewer takes it.
  struct Offer {
    std::uint64_t sequence = 0;
    FrameForm form;
    VideoPicture picture;  // set for video
  };

  static bool TakesVideo(const Watch& watch);
  static int JpegTier(const Watch& watch, const PublishedFrame& frame);
  // Returns true if the newest picture that the viewer has is smaller than the one that it would
  // get now.
  static bool IsTooSmall(const Watch& watch, const PublishedFrame& frame);
  // Returns the tier of the viewer's video stream for a frame of that width, or none if the viewer
  // gets JPEG.
  static std::optional<int> VideoTier(const Watch& watch, const PictureWidth& width);
  static std::size_t MaxInFlight(const Watch& watch);
  static bool IsReady(const Watch& watch, Time now);
  // The following functions need mutex_, except Made, NotMade, Newest, RestingFrameCame and
  // WakeAll, which must be called without it.
  //
  // Returns true if the viewer shows a resting frame of the scene and waits for the resting frame
  // of `next`. Until then, any other form of the frame would look worse.
  bool KeepsRestingFrame(const Watch& watch, const EncodedFrame& next, Time now) const;
  std::optional<Offer> OfferFor(const Watch& watch, PublishedFrame& frame, Time now) const;
  std::optional<Offer> VideoFor(const Watch& watch, const PublishedFrame& frame, int tier) const;
  std::optional<Offer> NextFor(const Watch& watch, Time now) const;
  bool HasFor(const Watch& watch, Time now) const;
  static std::shared_ptr<const EncodedFrame> Made(const Offer& offer, PublishedFrame& published);
  // Handles an offered frame that could not be encoded: it no longer counts as in flight. Returns
  // the current problem if the viewer has not received it yet.
  std::optional<FrameEvent> NotMade(std::uint64_t viewer_id, const Offer& offer);
  // Records that the viewer took the offer. Returns true if the viewer must be woken later for its
  // next frame.
  bool Took(Watch& watch, const Offer& offer, Time now);
  void SetLeastSteps(Time now);
  std::shared_ptr<PublishedFrame> Newest(std::uint64_t sequence) const;
  void RestingFrameCame();
  void WakeAll();

  const std::function<void()> on_demand_;
  const std::function<void()> on_wait_;
  const base::TimeSource& time_;
  mutable std::mutex mutex_;
  std::map<std::uint64_t, Watch> watches_;
  std::shared_ptr<PublishedFrame> frame_;
  // The time of the first frame of the newest scene whose resting frame has not arrived yet. Absent
  // if no resting frame is pending.
  std::optional<Time> resting_frame_due_since_;
  std::array<VideoStream, kTiers> streams_;
  std::optional<Problem> problem_;
  std::uint64_t problem_count_ = 0;
  std::uint64_t frame_count_ = 0;
  // Viewer ids are random, because a client that guesses another viewer's id could acknowledge
  // frames for it.
  std::random_device random_;
  absl::Status closed_because_;
};

}  // namespace thunderhead::delivery
