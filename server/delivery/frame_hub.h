// Distributes a session's newest frame to its viewers. Each viewer has at most two unacknowledged
// frames of JPEG, up to eight of video; a slow one skips frames and never slows another. A viewer
// with a slow link gets video where it can decode it, or smaller pictures; each form is encoded
// once, whatever the number of viewers. The hub keeps only one frame and one problem, and the
// newest base picture of each stream of video. Safe from any thread. Does not know how frames are
// drawn, encoded or sent.
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

// A viewer's wishes for the frames.
struct ViewerWants {
  int window_width_px = 0;         // 0: as the scene asks
  double frames_per_second = 0.0;  // at most; 0: as many as there are
  bool adapts = false;             // takes smaller pictures on a slow link
  bool takes_video = false;        // VP9, where that adapts
  bool takes_stills = false;       // AVIF
  bool saves_bytes = false;        // wants video although the link is fast

  bool operator==(const ViewerWants&) const = default;
};

// A viewer of the session. Wake is called from any thread, without the hub's lock, when Take may
// have something or the hub has closed.
class Viewer {
 public:
  virtual ~Viewer() = default;
  virtual void Wake() = 0;
};

// A picture that was encoded for a stream.
struct EncodedVideo {
  VideoOrder order;  // a key picture also where another was asked for
  EncodedFrame frame;
};

inline PictureWidth WidthOf(const EncodedFrame& frame) {
  return {frame.width_px, std::max(frame.full_width_px, frame.width_px)};
}

class FrameHub {
 public:
  using Time = std::chrono::steady_clock::time_point;

  // Of JPEG; for video FlightWindow.
  static constexpr std::size_t kMaxInFlight = 2;
  // From this many viewers on who can decode video, all of them get it: then one encoding costs
  // less than sending JPEG to all.
  static constexpr int kManyForVideo = 12;
  // The longest that a viewer with a still waits for the next of the same scene.
  static constexpr std::chrono::seconds kLongestForStill{2};

  // `on_demand` is called, without the lock, whenever a viewer joins, leaves or becomes ready for
  // another frame. `on_wait` is called, without the lock, when WakeWaiting is to be called in time.
  // `time` must outlive the hub; functions that are given no `at` read it.
  explicit FrameHub(
      std::function<void()> on_demand, std::function<void()> on_wait = [] {},
      const base::TimeSource& time = base::SteadyTime());

  // Returns the viewer's id, or the reason given to Close. Does not call Wake.
  absl::StatusOr<std::uint64_t> Join(std::shared_ptr<Viewer> viewer, const ViewerWants& wants = {});
  void SetWants(std::uint64_t viewer_id, const ViewerWants& wants);
  void Leave(std::uint64_t viewer_id);

  // Takes the newest frame or problem that the viewer has not had, unless too many of its frames
  // are in flight, i.e. taken and not yet acknowledged, or it wants fewer a second. A frame that
  // cannot be encoded is not in flight.
  std::optional<FrameEvent> Take(std::uint64_t viewer_id, std::optional<Time> at = std::nullopt);

  // Acknowledges every frame up to `sequence`. Wakes the viewer only if it may now take something,
  // and demands a frame only if it could take none before. False if there is no such viewer.
  bool Acknowledge(std::uint64_t viewer_id, std::uint64_t sequence,
                   std::optional<Time> at = std::nullopt);

  // It cannot decode the video that it was sent, and goes on with JPEG until a key picture comes.
  void LoseVideo(std::uint64_t viewer_id, std::optional<Time> at = std::nullopt);

  // Wakes those who have waited long enough for their next frame, as they want few a second.
  // Returns when the next has.
  std::optional<Time> WakeWaiting(Time now);

  // The pictures of video to encode of a frame before it is published. One at rest whose stills
  // follow is for those only who take them, and have none of its scene: others get it as JPEG.
  std::vector<VideoOrder> OrderVideo(const EncodedFrame& described, bool still_follows,
                                     std::optional<Time> at = std::nullopt);
  // Replaces the newest frame, which has no picture yet, encoded in every tier that a viewer wants
  // now. Returns its sequence.
  std::uint64_t Publish(EncodedFrame described, EncodeFrame encode = nullptr,
                        std::vector<EncodedVideo> video = {}, bool still_follows = false,
                        std::optional<Time> at = std::nullopt);
  // If the newest frame has that sequence: its still in a tier is there; there will be none; no
  // other has come for a while.
  void AddStill(std::uint64_t sequence, int tier, EncodedFrame still);
  void NoStills(std::uint64_t sequence);
  void Rest(std::uint64_t sequence);
  // Replaces the newest problem; a frame of the same or a newer revision ends it.
  void Publish(Problem problem);
  // The same, but wakes nobody, as a viewer may be taking the frame that has the problem.
  void Note(Problem problem);

  // Gives up the newest frame unless somebody watches; true if there was one.
  bool DropUnwatched();

  // Ends every viewer's stream with `why`; the first reason counts.
  void Close(const absl::Status& why);
  // OK while open.
  absl::Status ClosedBecause() const;

  bool HasViewers() const;
  std::size_t Viewers() const;
  // True if a viewer can be sent another frame now.
  bool HasReadyViewer() const;
  // The tiers in which viewers of a frame of that width take stills now.
  std::array<bool, kTiers> StillTiers(const PictureWidth& width) const;
  bool IsNewest(std::uint64_t sequence) const;

 private:
  struct Sent {
    std::uint64_t sequence = 0;
    Time at;
    bool moving = false;  // not a still
    bool video = false;
    bool was_last = false;           // no further one could be sent meanwhile
    std::optional<Time> changed_at;  // of the first frame of a revision
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
    std::optional<Time> waits_until;  // for its next frame
    std::uint64_t last_problem = 0;
    std::uint64_t last_revision = 0;
  };

  // A frame that a viewer can take, and its form.
  struct Offer {
    std::uint64_t sequence = 0;
    FrameForm form;
    VideoPicture picture;  // of video
  };

  static bool TakesVideo(const Watch& watch);
  static int JpegTier(const Watch& watch, const PublishedFrame& frame);
  // True if the picture that the viewer has is smaller than it would get now.
  static bool IsTooSmall(const Watch& watch, const PublishedFrame& frame);
  // The tier of the stream that it follows, for a frame of that width; none if it gets JPEG.
  static std::optional<int> VideoTier(const Watch& watch, const PictureWidth& width);
  static std::size_t MaxInFlight(const Watch& watch);
  static bool IsReady(const Watch& watch, Time now);
  // Need mutex_.
  // True if the viewer has a still of the frame's scene and waits for the frame's own still: any
  // other form of the frame would be worse.
  bool KeepsStill(const Watch& watch, const EncodedFrame& next, Time now) const;
  std::optional<Offer> OfferFor(const Watch& watch, PublishedFrame& frame, Time now) const;
  std::optional<Offer> VideoFor(const Watch& watch, const PublishedFrame& frame, int tier) const;
  std::optional<Offer> NextFor(const Watch& watch, Time now) const;
  bool HasFor(const Watch& watch, Time now) const;
  static std::shared_ptr<const EncodedFrame> Made(const Offer& offer, PublishedFrame& published);
  // The problem, if there is one, in place of an offered frame that could not be made. Without
  // mutex_.
  std::optional<FrameEvent> NotMade(std::uint64_t viewer_id, const Offer& offer);
  // True if it is to be woken for its next frame.
  bool Took(Watch& watch, const Offer& offer, Time now);
  void SetLeastSteps(Time now);
  std::shared_ptr<PublishedFrame> Newest(std::uint64_t sequence) const;
  void StillsCame();
  void WakeAll();

  const std::function<void()> on_demand_;
  const std::function<void()> on_wait_;
  const base::TimeSource& time_;
  mutable std::mutex mutex_;
  std::map<std::uint64_t, Watch> watches_;
  std::shared_ptr<PublishedFrame> frame_;
  // Since when frames of its scene have been published whose stills have not come.
  std::optional<Time> stills_due_since_;
  std::array<VideoStream, kTiers> streams_;
  std::optional<Problem> problem_;
  std::uint64_t problem_count_ = 0;
  std::uint64_t frame_count_ = 0;
  // Viewers' ids cannot be guessed, as who knows one may acknowledge for it.
  std::random_device random_;
  absl::Status closed_because_;
};

}  // namespace thunderhead::delivery
