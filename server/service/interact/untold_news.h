// The changes of a session that a person has not been sent yet: scene, catalogue, presence, marks,
// times in memory and pointers. Only the newest state of each is sent. Frames are handled elsewhere
// (delivery/frame_hub.h).
#pragma once

#include <grpcpp/support/byte_buffer.h>

#include <cstdint>
#include <optional>

#include "service/engine/catalogue_follower.h"
#include "session/sessions.h"

namespace thunderhead::service {

class UntoldNews {
 public:
  // Starts for a person who has just joined, and who knows the catalogue as it was after
  // `catalogue_changes` changes.
  UntoldNews(std::uint64_t person_id, bool marks_by_changes, std::uint64_t catalogue_changes)
      : person_id_(person_id), marks_by_changes_(marks_by_changes), catalogue_(catalogue_changes) {}

  // Returns the next message for the person; none if the person has been sent everything.
  std::optional<grpc::ByteBuffer> Next(session::Session& session,
                                       const CatalogueFollower& catalogue);

 private:
  const std::uint64_t person_id_;
  const bool marks_by_changes_;
  // For each subject, the number of its changes at the time of the last message about it.
  std::uint64_t scene_ = 0;
  std::uint64_t catalogue_;
  std::uint64_t presence_ = 0;
  std::uint64_t marks_ = 0;
  std::uint64_t times_ = 0;
  std::uint64_t pointers_ = 0;
};

}  // namespace thunderhead::service
