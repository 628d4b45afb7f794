// Reads only those fields of an InteractResponse that a load test needs, without copying or parsing
// the picture. This matters because the test shares its processors with the server that it
// measures.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "google/protobuf/io/zero_copy_stream.h"

namespace thunderhead::load {

// What a test reports if ReadResponse returns nothing.
inline constexpr char kUnreadable[] =
    "the server sent a message that cannot be parsed; run both programs in the same version";

struct Response {
  enum class Part { kFrame, kSceneTaken, kRefused, kOther };

  Part part = Part::kOther;
  std::uint64_t sequence = 0;        // set for a frame
  bool own_view = false;             // set for a frame
  std::uint64_t scene_revision = 0;  // set for a frame or a SceneTaken
  std::uint64_t request_id = 0;      // set for a SceneTaken or a refusal
  std::string refusal;               // the reason of a refusal
};

// Returns nothing if the message is malformed.
std::optional<Response> ReadResponse(google::protobuf::io::ZeroCopyInputStream& message);

}  // namespace thunderhead::load
