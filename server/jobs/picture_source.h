// The source of jobs' pictures, as jobs see it.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "jobs/job_record.h"

namespace thunderhead::jobs {

struct DrawnPicture {
  std::string bytes;      // of the file
  std::string extension;  // such as "png"
  std::string about;      // what clients are told of it, as the service serialized it
  double draw_ms = 0.0;   // time that it took from others
};

// A picture that was begun.
class PictureInHand {
 public:
  virtual ~PictureInHand() = default;

  // Ends it at its next piece. Safe from any thread; does not block.
  virtual void Cancel() = 0;
  // Called once, after it has said that it is done: the picture, or why there is none. May block.
  virtual absl::StatusOr<DrawnPicture> Take() = 0;
};

// Begins a picture, which calls `done` once, on any thread, perhaps before this returns. It may be
// destroyed after that only.
using BeginPicture = std::function<std::unique_ptr<PictureInHand>(const PictureOrder& order,
                                                                  std::function<void()> done)>;

}  // namespace thunderhead::jobs
