#include "session/frame_encoder.h"

#include <algorithm>
#include <utility>

#include "base/stopwatch.h"
#include "frame/halved.h"
#include "frame/image_codec.h"
#include "telemetry/metrics.h"

namespace thunderhead::session {
namespace {

// A coarse frame is blurred by its smaller buffer anyway and is soon replaced; fewer bytes make it
// arrive sooner.
constexpr int kCoarseJpegQuality = 75;

// Of smaller tiers, for links that are slow.
constexpr int kReducedJpegQuality = 70;

// The full frame with its picture at a half of the size, or a quarter.
EncodedFrame Reduced(const EncodedFrame& full, int tier, const frame::RgbImage& picture,
                     const SerializeFrame& serialize) {
  EncodedFrame reduced = full;
  frame::RgbImage smaller = picture;
  for (int halved = 0; halved < tier; ++halved) smaller = frame::Halved(smaller);
  const int quality = full.refined ? full.jpeg_quality : kReducedJpegQuality;
  auto jpeg = frame::EncodeJpeg(smaller.width_px, smaller.height_px, smaller.rgb, quality);
  if (!jpeg.ok()) return full;
  reduced.jpeg = *std::move(jpeg);
  reduced.width_px = smaller.width_px;
  reduced.height_px = smaller.height_px;
  reduced.tier = tier;
  reduced.serialized = serialize(reduced);
  return reduced;
}

void Count(const EncodedFrame& frame, const scene::Scene& scene) {
  telemetry::Metrics& counted = telemetry::Counted();
  counted.frames.Of(scene::NameOf(scene.rendering.technique)).Add();
  for (const StageTime& stage : frame.stages) {
    counted.stages.Of(scene::NameOf(stage.stage)).Observe(stage.milliseconds * 1e-3);
  }
}

void EncodeAndPublish(DrawnFrame drawn, const SerializeFrame& serialize) {
  const base::Stopwatch stopwatch;
  const int wanted_quality = drawn.scene.output.jpeg_quality;
  const DisplayFrame& picture = drawn.picture;
  EncodedFrame frame;
  frame.jpeg_quality =
      drawn.refined ? wanted_quality : std::min(wanted_quality, kCoarseJpegQuality);
  auto jpeg =
      frame::EncodeJpeg(picture.width_px, picture.height_px, picture.rgb, frame.jpeg_quality);
  if (!jpeg.ok()) {
    drawn.session->hub().Publish(ProblemOf(drawn.scene_revision, jpeg.status()));
    return;
  }
  frame.scene_revision = drawn.scene_revision;
  frame.jpeg = *std::move(jpeg);
  frame.width_px = picture.width_px;
  frame.height_px = picture.height_px;
  frame.camera = drawn.scene.camera;
  frame.view = drawn.view;
  frame.sun = drawn.scene.sun;
  frame.stages = std::move(drawn.picture.stages);
  frame.stages.push_back({scene::FrameStage::kEncode, stopwatch.ElapsedMs()});
  frame.modelled = std::move(drawn.picture.modelled);
  frame.refined = drawn.refined;
  frame.refinement = drawn.refinement;
  frame.accuracy = std::move(drawn.picture.accuracy);
  if (const auto newest = drawn.session->Newest();
      newest.has_value() && newest->revision == drawn.scene_revision) {
    frame.changed_at = newest->changed_at;
  }
  Count(frame, drawn.scene);
  frame.serialized = serialize(frame);
  // Kept with the frame, for a tier that is wanted later.
  const auto pixels = std::make_shared<const frame::RgbImage>(
      frame::RgbImage{picture.width_px, picture.height_px, std::move(drawn.picture.rgb)});
  drawn.session->hub().Publish(std::move(frame),
                               [pixels, serialize](const EncodedFrame& full, int tier) {
                                 return Reduced(full, tier, *pixels, serialize);
                               });
}

}  // namespace

FrameEncoder::FrameEncoder(int threads, SerializeFrame serialize, std::function<void()> on_encoded)
    : serialize_(std::move(serialize)), on_encoded_(std::move(on_encoded)) {
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

bool FrameEncoder::IsFullFor(const Session& session) {
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
    const std::shared_ptr<Session> session = drawn.session;
    encoding_.push_back(session.get());
    lock.unlock();
    EncodeAndPublish(std::move(drawn), serialize_);
    lock.lock();
    encoding_.erase(std::find(encoding_.begin(), encoding_.end(), session.get()));
    lock.unlock();
    // Another frame of the same session may have waited for this one.
    changed_.notify_one();
    on_encoded_();
    lock.lock();
  }
}

}  // namespace thunderhead::session
