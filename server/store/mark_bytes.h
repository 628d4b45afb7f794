// Converts a session's marks to and from bytes, for storage. Owner keys and domains of the marks
// are not included. The bytes are little-endian on every machine.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "session/board.h"

namespace thunderhead::store {

std::string ToBytes(const std::vector<session::Mark>& marks);
// Returns the marks from bytes that ToBytes has made, or DATA_LOSS if ToBytes cannot have made
// them.
absl::StatusOr<std::vector<session::Mark>> MarksFrom(const std::string& bytes);

}  // namespace thunderhead::store
