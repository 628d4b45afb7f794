// A format whose files, named after what they do, misbehave while they are described or read: the
// files that exploit a library, without the exploit.
#pragma once

#include "storm_files/storm_format.h"

namespace thunderhead::sandbox {

// The formats of this build, and that of files that end in ".bad".
storm_files::StormFormats FormatsWithMisbehaving();

}  // namespace thunderhead::sandbox
