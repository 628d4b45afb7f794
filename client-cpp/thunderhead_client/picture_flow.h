// Frames on their way to the screen: decoded on a thread of their own, of which the newest waits to
// be shown. A newer frame replaces one that waits, so that a picture is shown at most one frame
// late however slow decoding or drawing is. Of video every frame is decoded, as the next ones need
// it, and the newest one converted.
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
  v1::Frame frame;  // without its encoded bytes
  Pixels pixels;
  std::size_t bytes = 0;   // of the message
  double decode_ms = 0.0;  // of its own, without frames that were skipped
  std::string encoding;    // "JPEG", "VP9" or "AVIF"
  std::chrono::steady_clock::time_point received_at;
};

class PictureFlow {
 public:
  struct Steps {
    std::function<void()> ready;                       // a picture waits to be taken
    std::function<void(const v1::Frame&)> video_lost;  // until the next key frame
    std::function<void(const std::string&)> failed;    // a picture could not be decoded
  };

  // The steps are called on the decoding thread, without a lock.
  explicit PictureFlow(Steps steps);
  ~PictureFlow();
  PictureFlow(const PictureFlow&) = delete;
  PictureFlow& operator=(const PictureFlow&) = delete;

  // Ends the thread; what is offered afterwards is dropped. The destructor does it too.
  void Stop();
  // From any thread.
  void Offer(v1::Frame frame, std::size_t bytes);
  // The next message belongs to another call.
  void StartStream();
  // The newest decoded picture, once.
  std::unique_ptr<Picture> Take();
  // Gives a picture's memory back to be used again.
  void Return(std::unique_ptr<Picture> picture);
  // Frames that were never taken, because a newer one was there.
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
  PictureDecoder decoder_;  // of the thread alone
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Waiting> waiting_;  // one, or frames of video
  std::unique_ptr<Picture> ready_;
  std::unique_ptr<Picture> spare_;
  std::uint64_t stream_ = 0;
  bool restart_ = false;
  bool ends_ = false;
  std::uint64_t dropped_ = 0;
  std::thread thread_;
};

}  // namespace thunderhead::client
