// The wire format of proto files as lines of text, which can be stored next to them and compared.
// The rule for compatible changes is here too.
#pragma once

#include <set>
#include <string>

#include "google/protobuf/descriptor.h"

namespace thunderhead::service {

using FormatLines = std::set<std::string>;

// Returns a line for each field, oneof member, enumerator, reserved number and name, extension and
// call of `files`.
FormatLines FormatLinesOf(const std::set<const google::protobuf::FileDescriptor*>& files);

// Returns the lines of `listed` and `current` in which the format is incompatible with the listed
// one. The result is empty if clients built with the listed format still work. A field or an
// enumerator may be removed if its number and name are reserved. A listed field may not move into a
// oneof.
std::string Breaks(const FormatLines& listed, const FormatLines& current);

}  // namespace thunderhead::service
