// The source of jobs' pictures: an interface to whatever draws them.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "jobs/job_record.h"

namespace thunderhead::jobs {

struct DrawnPicture {
  std::string bytes;      // content of the file
  std::string extension;  // such as "png"
  std::string about;      // description for clients, as the service serialized it
  double draw_ms = 0.0;   // time that it took from other work
};

// A picture that was begun.
class PictureInHand {
 public:
  virtual ~PictureInHand() = default;

  // Ends the picture at its next piece. Safe from any thread; does not block.
  virtual void Cancel() = 0;
  // Returns the picture or its error. Called once, after the picture has called `done`. May block.
  virtual absl::StatusOr<DrawnPicture> Take() = 0;
};

// Begins a picture, which calls `done` once, on any thread, possibly before this function returns.
// The result may be destroyed only after that call.
using BeginPicture = std::function<std::unique_ptr<PictureInHand>(const PictureOrder& order,
                                                                  std::function<void()> done)>;

}  // namespace thunderhead::jobs
