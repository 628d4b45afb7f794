#include "thunderhead_client/picture_flow.h"

#include <utility>

namespace thunderhead::client {
namespace {

using Clock = std::chrono::steady_clock;

// Maximum number of waiting video frames. The server sends at most eight frames before it waits for
// acknowledgements, so more wait only if the decoder is far too slow.
constexpr std::size_t kMaxVideo = 30;

bool IsVideo(const v1::Frame& frame) { return !frame.vp9().empty(); }

const char* EncodingOf(const v1::Frame& frame) {
  if (IsVideo(frame)) return "VP9";
  return frame.avif().empty() ? "JPEG" : "AVIF";
}

}  // namespace

PictureFlow::PictureFlow(Steps steps) : steps_(std::move(steps)), thread_([this] { Run(); }) {}

PictureFlow::~PictureFlow() { Stop(); }

void PictureFlow::Stop() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
    waiting_.clear();
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void PictureFlow::Offer(v1::Frame frame, std::size_t bytes) {
  std::optional<v1::Frame> lost;
  {
    const std::lock_guard lock(mutex_);
    if (ends_) return;
    if (waiting_.size() >= kMaxVideo) {
      lost = waiting_.back().frame;
      dropped_ += waiting_.size();
      waiting_.clear();
      restart_ = true;
    }
    while (!waiting_.empty() && !IsVideo(waiting_.back().frame)) {
      waiting_.pop_back();
      ++dropped_;
    }
    waiting_.push_back({std::move(frame), bytes, Clock::now(), stream_});
  }
  changed_.notify_all();
  if (lost) steps_.video_lost(*lost);
}

void PictureFlow::StartStream() {
  const std::lock_guard lock(mutex_);
  ++stream_;
  dropped_ += waiting_.size();
  waiting_.clear();
  ready_.reset();
  restart_ = true;
}

std::unique_ptr<Picture> PictureFlow::Take() {
  const std::lock_guard lock(mutex_);
  return std::move(ready_);
}

void PictureFlow::Return(std::unique_ptr<Picture> picture) {
  const std::lock_guard lock(mutex_);
  spare_ = std::move(picture);
}

std::uint64_t PictureFlow::dropped() const {
  const std::lock_guard lock(mutex_);
  return dropped_;
}

void PictureFlow::Run() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return ends_ || !waiting_.empty(); });
    if (ends_) return;
    if (std::exchange(restart_, false)) decoder_.Restart();
    Waiting next = std::move(waiting_.front());
    waiting_.pop_front();
    const bool newest = waiting_.empty();
    if (!newest) ++dropped_;
    lock.unlock();
    // Every video frame is decoded because later frames depend on it.
    if (newest || IsVideo(next.frame)) Decode(std::move(next), newest);
    lock.lock();
  }
}

void PictureFlow::Decode(Waiting waiting, bool wanted) {
  std::unique_ptr<Picture> picture;
  {
    const std::lock_guard lock(mutex_);
    picture = std::move(spare_);
  }
  if (picture == nullptr) picture = std::make_unique<Picture>();
  const auto begin = Clock::now();
  const absl::Status status = decoder_.Decode(waiting.frame, wanted, picture->pixels);
  const std::chrono::duration<double, std::milli> took = Clock::now() - begin;
  if (!status.ok()) {
    Return(std::move(picture));
    if (IsVideo(waiting.frame)) {
      steps_.video_lost(waiting.frame);
    } else {
      steps_.failed(std::string(status.message()));
    }
    return;
  }
  if (!wanted) return Return(std::move(picture));
  picture->encoding = EncodingOf(waiting.frame);
  picture->frame = std::move(waiting.frame);
  picture->frame.clear_jpeg();
  picture->frame.clear_vp9();
  picture->frame.clear_avif();
  picture->bytes = waiting.bytes;
  picture->decode_ms = took.count();
  picture->received_at = waiting.received_at;
  {
    const std::lock_guard lock(mutex_);
    if (waiting.stream != stream_) return;
    std::swap(ready_, picture);
    if (picture != nullptr) {
      ++dropped_;
      spare_ = std::move(picture);
    }
  }
  steps_.ready();
}

}  // namespace thunderhead::client
