// The wire format of proto files as lines of text that can be kept beside them and compared, and
// the rule for which changes of it existing clients survive.
#pragma once

#include <set>
#include <string>

#include "google/protobuf/descriptor.h"

namespace thunderhead::service {

using FormatLines = std::set<std::string>;

// A line for each field, oneof member, enumerator, reserved number and name, extension and call of
// `files`.
FormatLines FormatLinesOf(const std::set<const google::protobuf::FileDescriptor*>& files);

// The lines of `listed` and `current` by which the format stopped being the one that is listed,
// empty if clients built with the listed format still work. A field or an enumerator may go if its
// number and its name are reserved; a listed field may not move into a oneof.
std::string Breaks(const FormatLines& listed, const FormatLines& current);

}  // namespace thunderhead::service
