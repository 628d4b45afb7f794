// Marks as bytes, without their owners' keys and domains, little-endian whatever the machine.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "session/board.h"

namespace thunderhead::store {

std::string ToBytes(const std::vector<session::Mark>& marks);
// DATA_LOSS for bytes that ToBytes does not make.
absl::StatusOr<std::vector<session::Mark>> MarksFrom(const std::string& bytes);

}  // namespace thunderhead::store
