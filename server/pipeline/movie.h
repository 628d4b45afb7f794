// Movies of pictures by libavcodec, in this process: VP9 in WebM, or H.264 in MP4 where libavcodec
// has an encoder of it.
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

// True for a name that ends in .webm or .mp4.
bool IsMovieName(std::string_view path);

// For how many of the movie's frames each picture stands, so that every frame lasts the same time
// of the storm: the shortest step between two pictures. `valid` are their times, in order; the last
// picture stands for one. A gap of a thousand steps counts as one.
std::vector<int> FramesOfPictures(const std::vector<absl::Time>& valid);

// In the movie's metadata, where players and ffprobe show it.
struct MovieText {
  std::string title;
  std::string comment;
  std::string description = {};
};

// Reads the picture of that index; all have one size.
using MoviePicture = std::function<absl::StatusOr<frame::RgbImage>(std::size_t)>;

// Writes the movie at `path`, whole or not at all. `frames[i]` says for how many frames picture i
// stands. Errors: those of `picture`, those of base::WriteWholeFile, FAILED_PRECONDITION if there
// is no encoder, and INVALID_ARGUMENT for pictures that differ in size or that it cannot encode.
absl::Status WriteMovie(const std::string& path, const std::vector<int>& frames,
                        int frames_per_second, const MovieText& text, const MoviePicture& picture);

}  // namespace thunderhead::pipeline
