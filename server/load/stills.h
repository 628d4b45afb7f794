// A burst of single pictures beside a load: all are asked for at once, each by a call of its own.
#pragma once

#include <mutex>
#include <stop_token>
#include <thread>
#include <utility>
#include <vector>

#include "load/recording.h"
#include "load/transport.h"

namespace thunderhead::load {

struct StillOptions {
  int count = 0;
  int width_px = 640;
  int height_px = 360;
  int slices = 0;  // 0: the default
  double patience_s = 3600.0;
};

class Stills {
 public:
  // A stop ends the waiting. `transport` and `errors` must outlive it.
  Stills(const StillOptions& options, Transport& transport, std::stop_token stop, Errors& errors)
      : options_(options), transport_(transport), stop_(std::move(stop)), errors_(errors) {}
  ~Stills() { Join(); }
  Stills(const Stills&) = delete;
  Stills& operator=(const Stills&) = delete;

  // Asks for all of them. The load's storm and light are the server's defaults, each with the
  // camera turned a little further.
  void Begin();
  // Waits until each has come, was refused, or is not waited for any more.
  void Join();
  // From asking to the picture; once joined.
  StillRecord Record() const { return {options_.count, came_ms_}; }

 private:
  void Ask(int index);

  const StillOptions options_;
  Transport& transport_;
  const std::stop_token stop_;
  Errors& errors_;
  std::mutex mutex_;
  std::vector<double> came_ms_;
  std::vector<std::thread> threads_;
};

}  // namespace thunderhead::load
