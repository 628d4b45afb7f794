// The draining of a server: it takes no new work, and ends when the work begun before is done.
#pragma once

#include <atomic>

#include "absl/status/status.h"
#include "base/error_details.h"

namespace thunderhead::service {

class Drain {
 public:
  // From now on new pictures are refused.
  void Begin() { begun_ = true; }
  bool HasBegun() const { return begun_; }

  // Pictures that were begun and not yet delivered.
  int Pictures() const { return pictures_; }

  // A picture, from its request to its delivery.
  class Picture {
   public:
    explicit Picture(Drain& drain) : drain_(drain) { ++drain_.pictures_; }
    ~Picture() { --drain_.pictures_; }
    Picture(const Picture&) = delete;
    Picture& operator=(const Picture&) = delete;

    // Refuses what comes after Begin.
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

}  // namespace thunderhead::service
