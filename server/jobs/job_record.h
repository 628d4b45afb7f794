// The kept state of a job of pictures. Plain values; what a picture shows, and what is told of a
// drawn one, are bytes that the service makes and reads.
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

// Of a job's id.
inline constexpr std::size_t kIdDigits = 32;

enum class PictureState {
  kWaiting,
  kDrawing,  // never saved: the server that drew is gone when it is read
  kDrawn,
  kFailed,
  kCancelled,
  kDropped,  // its result made room for others
};
inline constexpr std::size_t kPictureStates = 6;

// Why there is no picture, as a client is told.
struct Problem {
  absl::StatusCode code = absl::StatusCode::kOk;
  std::string reason = {};  // as base::ErrorDetails
  std::string message = {};

  bool operator==(const Problem&) const = default;
};

// The request.
struct PictureOrder {
  std::string name;  // the client's
  std::string request;
  // That the request's time had then, to find it again if others come before it; empty: unknown.
  std::string valid_time;

  bool operator==(const PictureOrder&) const = default;
};

struct PictureRecord {
  PictureOrder order;
  PictureState state = PictureState::kWaiting;
  int attempts = 0;  // begun, and not put back by a server that ended in order
  Problem problem;   // of those that failed or were dropped
  // Of those that are drawn.
  std::uint64_t bytes = 0;
  std::string sha256;
  std::string extension;  // of the file, such as "png"
  double milliseconds = 0.0;
  Time drawn_at = {};
  bool fetched = false;

  bool operator==(const PictureRecord&) const = default;
};

struct JobRecord {
  std::string id;          // unguessable, as is
  std::string result_key;  // which neither tells the other
  std::string owner;
  std::string label;  // the client's
  Time created_at = {};
  std::optional<Time> ended_at = {};
  bool cancelled = false;
  std::vector<PictureRecord> pictures;

  bool operator==(const JobRecord&) const = default;
};

}  // namespace thunderhead::jobs
