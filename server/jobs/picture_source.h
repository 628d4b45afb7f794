// The interface between render jobs and the code that draws their pictures.
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
  double draw_ms = 0.0;   // drawing time, during which other work had to wait
};

// A picture that is being drawn, or was drawn and not taken yet.
class PictureInHand {
 public:
  virtual ~PictureInHand() = default;

  // Ends the drawing after the piece of work in progress. Safe from any thread. Does not block.
  virtual void Cancel() = 0;
  // Returns the drawn picture or the error. Must be called once, after `done` was called. May
  // block.
  virtual absl::StatusOr<DrawnPicture> Take() = 0;
};

// A function that begins to draw a picture. When the drawing has ended, `done` is called once, on
// any thread, possibly before the function returns. The returned object may be destroyed only after
// that call.
using BeginPicture = std::function<std::unique_ptr<PictureInHand>(const PictureOrder& order,
                                                                  std::function<void()> done)>;

}  // namespace thunderhead::jobs
