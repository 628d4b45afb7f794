// A call of Interact. Only the files of Session use it.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>

#include "thunderhead_client/session.h"

namespace thunderhead::client {

// One call of Interact: its stream and its unanswered requests. The session's mutex guards all
// members except the stream.
struct Session::Call {
  static constexpr std::size_t kMaxRemembered = 512;
  struct SentScene {
    std::uint64_t ticket = 0;
    Clock::time_point at;
  };

  grpc::ClientContext context;
  std::unique_ptr<grpc::ClientReaderWriter<v1::InteractRequest, v1::InteractResponse>> stream;
  bool joined = false;
  bool over = false;
  Clock::time_point began = Clock::now();
  Clock::time_point joined_at{};
  Clock::time_point heard_at = Clock::now();
  std::optional<Outcome> farewell;
  std::uint64_t last_request = 0;
  std::map<std::uint64_t, SentScene> scenes;  // sent scenes without a response, by request_id
  // Kinds of the newest kMaxRemembered requests, by request_id.
  std::map<std::uint64_t, v1::InteractRequest::MessageCase> requests;
};

}  // namespace thunderhead::client
