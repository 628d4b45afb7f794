// Makes movies from pictures with libavcodec, in this process: VP9 in WebM, or H.264 in MP4 if
// libavcodec has an H.264 encoder.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "frame/image_codec.h"

namespace thunderhead::pipeline {

// Returns true for a name that ends in .webm or .mp4.
bool IsMovieName(std::string_view path);

// Returns for each picture the number of movie frames that show it. Each movie frame covers the
// same time of the storm: the shortest step between two pictures. `valid` are the pictures' valid
// times in order. The last picture gets one frame, and so does a picture before a gap of a thousand
// steps or more.
std::vector<int> FramesOfPictures(const std::vector<absl::Time>& valid);

// Text in the movie's metadata, which players and ffprobe show.
struct MovieText {
  std::string title;
  std::string comment;
  std::string description = {};
};

// A function that reads the picture with that index. All pictures must have the same size.
using MoviePicture = std::function<absl::StatusOr<frame::RgbImage>(std::size_t)>;

// Writes the movie at `path`, completely or not at all. `frames[i]` is the number of movie frames
// of picture i. Returns the errors of `picture` and of base::WriteWholeFile. Returns
// FAILED_PRECONDITION if there is no encoder, and INVALID_ARGUMENT if pictures differ in size or
// cannot be encoded.
absl::Status WriteMovie(const std::string& path, const std::vector<int>& frames,
                        int frames_per_second, const MovieText& text, const MoviePicture& picture);

}  // namespace thunderhead::pipeline
