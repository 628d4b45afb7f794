// The news of a session that a person has not been told yet: of the scene, the catalogue, the
// people there, marks, times in memory and pointers, each in its newest state alone. Frames are not
// among them.
#pragma once

#include <grpcpp/support/byte_buffer.h>

#include <cstdint>
#include <optional>

#include "service/catalogue_follower.h"
#include "session/sessions.h"

namespace thunderhead::service {

class UntoldNews {
 public:
  // Of a person who has just joined, and knows the catalogue as it is after `catalogue_changes`.
  UntoldNews(std::uint64_t person_id, bool marks_by_changes, std::uint64_t catalogue_changes)
      : person_id_(person_id), marks_by_changes_(marks_by_changes), catalogue_(catalogue_changes) {}

  // The next message for them, if there is any.
  std::optional<grpc::ByteBuffer> Next(session::Session& session,
                                       const CatalogueFollower& catalogue);

 private:
  const std::uint64_t person_id_;
  const bool marks_by_changes_;
  // How often each had changed when it was told last.
  std::uint64_t scene_ = 0;
  std::uint64_t catalogue_;
  std::uint64_t presence_ = 0;
  std::uint64_t marks_ = 0;
  std::uint64_t times_ = 0;
  std::uint64_t pointers_ = 0;
};

}  // namespace thunderhead::service
