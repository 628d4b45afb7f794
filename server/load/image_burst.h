// A burst of single pictures (RenderImage) during a load test. All are requested at once, each by a
// separate call.
#pragma once

#include <mutex>
#include <stop_token>
#include <thread>
#include <utility>
#include <vector>

#include "load/recording.h"
#include "load/transport.h"

namespace thunderhead::load {

struct ImageBurstOptions {
  int count = 0;
  int width_px = 640;
  int height_px = 360;
  int slices = 0;  // number of slices; 0 means the default
  double patience_s = 3600.0;
};

class ImageBurst {
 public:
  // `stop` ends waiting for the pictures. `transport` and `errors` must outlive this object.
  ImageBurst(const ImageBurstOptions& options, Transport& transport, std::stop_token stop,
             Errors& errors)
      : options_(options), transport_(transport), stop_(std::move(stop)), errors_(errors) {}
  ~ImageBurst() { Join(); }
  ImageBurst(const ImageBurst&) = delete;
  ImageBurst& operator=(const ImageBurst&) = delete;

  // Requests all pictures. Storm and light are the server's defaults. The camera of each picture is
  // turned a little further than that of the one before.
  void Begin();
  // Waits until each picture has arrived, was refused or has timed out.
  void Join();
  // Returns the times from the request to each picture. Must be called after Join.
  ImageBurstRecord Record() const { return {options_.count, came_ms_}; }

 private:
  void Ask(int index);

  const ImageBurstOptions options_;
  Transport& transport_;
  const std::stop_token stop_;
  Errors& errors_;
  std::mutex mutex_;
  std::vector<double> came_ms_;
  std::vector<std::thread> threads_;
};

}  // namespace thunderhead::load
