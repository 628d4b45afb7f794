// The draining of a server: it accepts no new work, and ends when the work in progress is done.
#pragma once

#include <atomic>

#include "absl/status/status.h"
#include "base/error_details.h"

namespace thunderhead::rpc_port {

class Drain {
 public:
  // Starts to refuse new work: pictures, and viewers who join.
  void Begin() { begun_ = true; }
  bool HasBegun() const { return begun_; }

  // Returns the number of pictures that were started and not yet delivered.
  int Pictures() const { return pictures_; }

  // Counts a picture as long as this object exists: from its request to its delivery.
  class Picture {
   public:
    explicit Picture(Drain& drain) : drain_(drain) { ++drain_.pictures_; }
    ~Picture() { --drain_.pictures_; }
    Picture(const Picture&) = delete;
    Picture& operator=(const Picture&) = delete;

    // Returns an error once Begin was called, because new work is then refused.
    absl::Status Check() const {
      return drain_.HasBegun() ? base::ShuttingDown() : absl::OkStatus();
    }

   private:
    Drain& drain_;
  };

 private:
  std::atomic<bool> begun_{false};
  std::atomic<int> pictures_{0};
};

}  // namespace thunderhead::rpc_port
