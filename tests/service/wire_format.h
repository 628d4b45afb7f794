// Describes the wire format of proto files as lines of text, which can be stored next to the files
// and compared. This file also defines which changes of the format are compatible.
#pragma once

#include <set>
#include <string>

#include "google/protobuf/descriptor.h"

namespace thunderhead::service {

using FormatLines = std::set<std::string>;

// Returns a line for each field, oneof member, enumerator, reserved number and name, extension and
// call of `files`.
FormatLines FormatLinesOf(const std::set<const google::protobuf::FileDescriptor*>& files);

// Returns the lines of `listed` and `current` in which the current format is incompatible with the
// listed format. The result is empty if clients that were built with the listed format still work.
// A field or an enumerator may be removed if its number and name are reserved. A listed field may
// not move into a oneof.
std::string Breaks(const FormatLines& listed, const FormatLines& current);

}  // namespace thunderhead::service
