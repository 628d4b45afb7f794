// The stored state of a job. Plain values. A picture's request and the description of its result
// are bytes that the service makes and reads.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"

namespace thunderhead::jobs {

using Time = std::chrono::system_clock::time_point;

// Length of a job's id.
inline constexpr std::size_t kIdDigits = 32;

enum class PictureState {
  kWaiting,
  kDrawing,  // never saved, because the server that drew it no longer runs when the record is read
  kDrawn,
  kFailed,
  kCancelled,
  kDropped,  // its result was evicted
};
inline constexpr std::size_t kPictureStates = 6;

// The reason for a missing picture, as clients are told.
struct Problem {
  absl::StatusCode code = absl::StatusCode::kOk;
  std::string reason = {};  // as in base::ErrorDetails
  std::string message = {};

  bool operator==(const Problem&) const = default;
};

// The request for a picture.
struct PictureOrder {
  std::string name;  // given by the client
  std::string request;
  // The valid time of the request's time index, to find it again if earlier times are added; empty:
  // unknown.
  std::string valid_time;

  bool operator==(const PictureOrder&) const = default;
};

struct PictureRecord {
  PictureOrder order;
  PictureState state = PictureState::kWaiting;
  int attempts = 0;  // starts, except those that an orderly shutdown put back
  Problem problem;   // set for failed and dropped pictures
  // The following are set for drawn pictures.
  std::uint64_t bytes = 0;
  std::string sha256;
  std::string extension;  // extension of the file, such as "png"
  double milliseconds = 0.0;
  Time drawn_at = {};
  bool fetched = false;

  bool operator==(const PictureRecord&) const = default;
};

struct JobRecord {
  std::string id;          // unguessable
  std::string result_key;  // also unguessable, and not derivable from the id
  std::string owner;
  std::string label;  // given by the client
  Time created_at = {};
  std::optional<Time> ended_at = {};
  bool cancelled = false;
  std::vector<PictureRecord> pictures;

  bool operator==(const JobRecord&) const = default;
};

}  // namespace thunderhead::jobs
