// Converts marks to and from bytes, without their owner keys and domains. The bytes are
// little-endian on every machine.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "session/board.h"

namespace thunderhead::store {

std::string ToBytes(const std::vector<session::Mark>& marks);
// DATA_LOSS if ToBytes cannot have made the bytes.
absl::StatusOr<std::vector<session::Mark>> MarksFrom(const std::string& bytes);

}  // namespace thunderhead::store
