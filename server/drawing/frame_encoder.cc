#include "drawing/frame_encoder.h"

#include <algorithm>
#include <utility>

#include "base/guarded.h"
#include "base/log.h"
#include "base/status.h"
#include "base/stopwatch.h"
#include "delivery/picture_sizes.h"
#include "frame/image_codec.h"
#include "telemetry/metrics.h"

namespace thunderhead::drawing {
namespace {

// The JPEG quality of a coarse frame. Such a frame is blurred anyway, because its buffer is smaller
// than the picture, and it is soon replaced. With fewer bytes it arrives sooner.
constexpr int kCoarseJpegQuality = 75;

// The JPEG quality of a coarse frame in a smaller tier (delivery/link_estimate.h), which goes to
// viewers with slow links.
constexpr int kReducedJpegQuality = 70;

using Pictures = delivery::PictureSizes<frame::RgbImage>;

void Count(const StageTime& stage) {
  telemetry::Counted().stages.Of(scene::NameOf(stage.stage)).Observe(stage.milliseconds * 1e-3);
}

void Count(const delivery::EncodedFrame& described, const scene::Scene& scene) {
  telemetry::Counted().frames.Of(scene::NameOf(scene.rendering.technique)).Add();
  for (const StageTime& stage : described.stages) Count(stage);
}

// Returns the frame without a picture.
delivery::EncodedFrame Described(DrawnFrame& drawn, session::Clock::time_point now) {
  delivery::EncodedFrame frame;
  frame.scene_revision = drawn.scene_revision;
  frame.width_px = drawn.picture.width_px;
  frame.height_px = drawn.picture.height_px;
  frame.full_width_px = drawn.scene.output.width_px;
  frame.camera = drawn.scene.camera;
  frame.view = drawn.view;
  frame.sun = drawn.scene.sun;
  frame.stages = std::move(drawn.picture.stages);
  frame.modelled = std::move(drawn.picture.modelled);
  frame.refined = drawn.refined;
  frame.at_rest = drawn.refined && now >= drawn.rests_at;
  frame.refinement = drawn.refinement;
  frame.accuracy = std::move(drawn.picture.accuracy);
  frame.memory = std::move(drawn.picture.memory);
  if (const auto newest = drawn.session->Newest();
      newest.has_value() && newest->revision == drawn.scene_revision) {
    frame.changed_at = newest->changed_at;
  }
  return frame;
}

// Returns the frame with the size of a tier but without a picture.
delivery::EncodedFrame At(const delivery::EncodedFrame& described, int tier,
                          const frame::RgbImage& picture) {
  delivery::EncodedFrame frame = described;
  frame.width_px = picture.width_px;
  frame.height_px = picture.height_px;
  frame.tier = tier;
  return frame;
}

absl::StatusOr<delivery::EncodedFrame> WithJpeg(const delivery::EncodedFrame& described, int tier,
                                                const frame::RgbImage& picture, int wanted_quality,
                                                const SerializeFrame& serialize) {
  const base::Stopwatch stopwatch;
  int quality = wanted_quality;
  if (!described.refined) {
    quality = tier > 0 ? kReducedJpegQuality : std::min(wanted_quality, kCoarseJpegQuality);
  }
  delivery::EncodedFrame frame = At(described, tier, picture);
  THUNDERHEAD_ASSIGN_OR_RETURN(
      frame.jpeg, frame::EncodeJpeg(picture.width_px, picture.height_px, picture.rgb, quality));
  frame.stages.push_back({scene::FrameStage::kEncode, stopwatch.ElapsedMs()});
  Count(frame.stages.back());
  frame.serialized = serialize(frame);
  return frame;
}

absl::StatusOr<delivery::EncodedVideo> WithVideo(const delivery::EncodedFrame& described,
                                                 delivery::VideoOrder order,
                                                 const frame::RgbImage& picture,
                                                 delivery::VideoEncoders& encoders,
                                                 base::MemoryBudget& memory,
                                                 const SerializeFrame& serialize) {
  const base::Stopwatch stopwatch;
  delivery::EncodedFrame frame = At(described, order.tier, picture);
  THUNDERHEAD_ASSIGN_OR_RETURN(codec::Vp9Picture encoded, encoders.Encode(picture, &order, memory));
  frame.vp9 = std::move(encoded.bytes);
  frame.key_frame = encoded.key;
  frame.stages.push_back({scene::FrameStage::kEncode, stopwatch.ElapsedMs()});
  Count(frame.stages.back());
  frame.serialized = serialize(frame);
  return delivery::EncodedVideo{order, std::move(frame)};
}

// Returns the video pictures that viewers wait for. If encoding fails, the picture is left out, and
// its viewers get JPEG.
std::vector<delivery::EncodedVideo> VideoOf(const delivery::EncodedFrame& described,
                                            session::Session& session, bool resting_frame_follows,
                                            Pictures& pictures, base::MemoryBudget& memory,
                                            const SerializeFrame& serialize) {
  std::vector<delivery::EncodedVideo> video;
  for (const delivery::VideoOrder& order :
       session.hub().OrderVideo(described, resting_frame_follows)) {
    auto encoded = base::Guarded([&] {
      return WithVideo(described, order, pictures.At(order.tier), session.video(), memory,
                       serialize);
    });
    if (encoded.ok()) {
      video.push_back(*std::move(encoded));
      // Refusals for lack of memory are not logged here. They are counted elsewhere.
    } else if (!absl::IsResourceExhausted(encoded.status())) {
      base::LogError(base::Annotate(encoded.status(), "encoding video"));
    }
  }
  return video;
}

// Returns a function that encodes a tier as JPEG. An error is published as the frame's problem.
delivery::EncodeFrame JpegEncoder(const std::shared_ptr<session::Session>& session,
                                  const std::shared_ptr<Pictures>& pictures, int wanted_quality,
                                  const SerializeFrame& serialize) {
  // The session owns the frame, and the frame owns this function, so the pointer must be weak.
  return [weak_session = std::weak_ptr(session), pictures, wanted_quality, serialize](
             const delivery::EncodedFrame& described,
             int tier) -> std::optional<delivery::EncodedFrame> {
    auto frame = base::Guarded(
        [&] { return WithJpeg(described, tier, pictures->At(tier), wanted_quality, serialize); });
    if (frame.ok()) return *std::move(frame);
    if (const auto owner = weak_session.lock(); owner != nullptr) {
      owner->hub().Note(delivery::ProblemOf(described.scene_revision, frame.status()));
    }
    return std::nullopt;
  };
}

void EncodeAndPublish(DrawnFrame drawn, const SerializeFrame& serialize, base::MemoryBudget& memory,
                      RestingFrameEncoder& resting_frames, session::Clock::time_point now) {
  const std::shared_ptr<session::Session>& session = drawn.session;
  const delivery::EncodedFrame described = Described(drawn, now);
  Count(described, drawn.scene);
  const auto pictures = std::make_shared<Pictures>(frame::RgbImage{
      drawn.picture.width_px, drawn.picture.height_px, std::move(drawn.picture.rgb)});
  const bool resting_frame_follows = drawn.fine.has_value();
  auto video = VideoOf(described, *session, resting_frame_follows, *pictures, memory, serialize);
  const std::uint64_t sequence = session->hub().Publish(
      described, JpegEncoder(session, pictures, drawn.scene.output.jpeg_quality, serialize),
      std::move(video), resting_frame_follows);
  if (!drawn.refined) return;
  const absl::Status made = base::Guarded([&] {
    RestingFrame resting{session, sequence, described, drawn.rests_at, nullptr};
    if (resting_frame_follows) {
      resting.fine =
          std::make_shared<delivery::PictureSizes<frame::FineImage>>(*std::move(drawn.fine));
    }
    resting_frames.Encode(std::move(resting));
    return absl::OkStatus();
  });
  // The frame is published already, so viewers must not wait for its resting frame.
  if (!made.ok()) session->hub().NoRestingFrame(sequence);
}

}  // namespace

FrameEncoder::FrameEncoder(int threads, SerializeFrame serialize,
                           std::shared_ptr<base::MemoryBudget> memory,
                           std::function<void()> on_encoded, const base::TimeSource& time)
    : serialize_(std::move(serialize)),
      memory_(std::move(memory)),
      on_encoded_(std::move(on_encoded)),
      time_(time),
      resting_frames_(serialize_, time) {
  for (int i = 0; i < threads; ++i) threads_.emplace_back([this] { Run(); });
}

FrameEncoder::~FrameEncoder() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void FrameEncoder::Encode(DrawnFrame frame) {
  {
    const std::lock_guard lock(mutex_);
    waiting_.push_back(std::move(frame));
  }
  changed_.notify_one();
}

bool FrameEncoder::IsFullFor(const session::Session& session) {
  const std::lock_guard lock(mutex_);
  const auto pending =
      std::count(encoding_.begin(), encoding_.end(), &session) +
      std::count_if(waiting_.begin(), waiting_.end(),
                    [&](const DrawnFrame& frame) { return frame.session.get() == &session; });
  return pending >= kMaxPending;
}

std::deque<DrawnFrame>::iterator FrameEncoder::NextFrame() {
  return std::find_if(waiting_.begin(), waiting_.end(), [this](const DrawnFrame& frame) {
    return std::find(encoding_.begin(), encoding_.end(), frame.session.get()) == encoding_.end();
  });
}

void FrameEncoder::Run() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return stopping_ || NextFrame() != waiting_.end(); });
    if (stopping_) return;
    const auto next = NextFrame();
    DrawnFrame drawn = std::move(*next);
    waiting_.erase(next);
    const std::shared_ptr<session::Session> session = drawn.session;
    encoding_.push_back(session.get());
    lock.unlock();
    const std::uint64_t revision = drawn.scene_revision;
    const absl::Status encoded = base::Guarded([&] {
      EncodeAndPublish(std::move(drawn), serialize_, *memory_, resting_frames_, time_.Now());
      return absl::OkStatus();
    });
    if (!encoded.ok()) session->hub().Publish(delivery::ProblemOf(revision, encoded));
    lock.lock();
    encoding_.erase(std::find(encoding_.begin(), encoding_.end(), session.get()));
    lock.unlock();
    // Another frame of the same session may have waited for this one, so a thread is woken for it.
    changed_.notify_one();
    on_encoded_();
    lock.lock();
  }
}

}  // namespace thunderhead::drawing
