// The queue of frames between the network and the screen. A separate thread decodes the frames, and
// the newest decoded picture waits to be shown. A newer frame replaces a waiting frame. A picture
// is therefore shown at most one frame late, however slow decoding or drawing is. Every video frame
// is decoded, because later frames depend on it, but only the newest video frame is converted to
// pixels.
#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "thunderhead_client/picture_decoder.h"

namespace thunderhead::client {

struct Picture {
  v1::Frame frame;  // the frame's message without the encoded picture
  Pixels pixels;
  std::size_t bytes = 0;  // size of the message that contained the frame
  // Decode time of this frame, without the time of earlier frames that were not shown.
  double decode_ms = 0.0;
  std::string encoding;  // "JPEG", "VP9" or "AVIF"
  std::chrono::steady_clock::time_point received_at;
};

class PictureFlow {
 public:
  struct Steps {
    std::function<void()> ready;  // a picture is ready to be taken
    // Video is undecodable until the next key frame.
    std::function<void(const v1::Frame&)> video_lost;
    std::function<void(const std::string&)> failed;  // a picture could not be decoded
  };

  // The decoding thread calls the functions in `steps`. Offer() calls video_lost, too, if too many
  // frames wait. No lock is held meanwhile.
  explicit PictureFlow(Steps steps);
  ~PictureFlow();
  PictureFlow(const PictureFlow&) = delete;
  PictureFlow& operator=(const PictureFlow&) = delete;

  // Ends the thread. Frames that are offered afterwards are dropped. The destructor calls this,
  // too.
  void Stop();
  // Adds a frame to decode. Any thread may call this.
  void Offer(v1::Frame frame, std::size_t bytes);
  // Begins a new stream, because the next frame comes from another Interact call.
  void StartStream();
  // Returns the newest decoded picture; null if it was already taken.
  std::unique_ptr<Picture> Take();
  // Gives a picture back, so that its memory can be reused.
  void Return(std::unique_ptr<Picture> picture);
  // Returns the number of frames that were replaced by newer frames before they were taken.
  std::uint64_t dropped() const;

 private:
  struct Waiting {
    v1::Frame frame;
    std::size_t bytes = 0;
    std::chrono::steady_clock::time_point received_at;
    std::uint64_t stream = 0;
  };

  void Run();
  void Decode(Waiting waiting, bool wanted);

  const Steps steps_;
  PictureDecoder decoder_;  // used only by the decoding thread
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  // Video frames, then at most one JPEG or AVIF frame.
  std::deque<Waiting> waiting_;
  std::unique_ptr<Picture> ready_;
  std::unique_ptr<Picture> spare_;
  std::uint64_t stream_ = 0;
  bool restart_ = false;
  bool ends_ = false;
  std::uint64_t dropped_ = 0;
  std::thread thread_;
};

}  // namespace thunderhead::client
