// The stored state of render jobs. A picture's request is a text of bytes that only the service
// writes and parses.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"

namespace thunderhead::jobs {

using Time = std::chrono::system_clock::time_point;

// The number of hexadecimal digits of a job's id.
inline constexpr std::size_t kIdDigits = 32;
// Returns whether a text has the form of a job's id.
inline bool IsJobId(std::string_view text) {
  return text.size() == kIdDigits &&
         text.find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

enum class PictureState {
  kWaiting,
  kDrawing,  // this state is never saved, because no picture is being drawn when a server loads the
             // record
  kDrawn,
  kFailed,
  kCancelled,
  kDropped,  // the picture was drawn, but its result was evicted
};
inline constexpr std::size_t kPictureStates = 6;

// The reason why a picture is missing, as reported to clients.
struct Problem {
  absl::StatusCode code = absl::StatusCode::kOk;
  std::string reason = {};  // as in base::ErrorDetails
  std::string message = {};

  bool operator==(const Problem&) const = default;
};

// The request for one picture of a job.
struct PictureOrder {
  std::string name;  // given by the client
  std::string request;
  // The valid time that the request's time index refers to. It identifies the time even if earlier
  // times are added to the storm. Empty if unknown.
  std::string valid_time;

  bool operator==(const PictureOrder&) const = default;
};

struct ImageRecord {
  PictureOrder order;
  PictureState state = PictureState::kWaiting;
  int attempts = 0;  // number of times that drawing was begun, without attempts that do not count
                     // (JobBoard::PutBack)
  Problem problem;   // set for failed and dropped pictures
  // The following are set for drawn pictures.
  std::uint64_t bytes = 0;
  std::string sha256;
  std::string extension;  // extension of the file, such as "png"
  double milliseconds = 0.0;
  Time drawn_at = {};
  bool fetched = false;

  bool operator==(const ImageRecord&) const = default;
};

struct JobRecord {
  std::string id;          // random name, which cannot be guessed
  std::string result_key;  // a second random name, which cannot be guessed or derived from the id
  std::string owner;
  std::string label;  // given by the client
  Time created_at = {};
  std::optional<Time> ended_at = {};
  bool cancelled = false;
  std::vector<ImageRecord> pictures;

  bool operator==(const JobRecord&) const = default;
};

}  // namespace thunderhead::jobs
