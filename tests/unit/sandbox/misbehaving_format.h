// A format whose files, named after what they do, misbehave while they are described or read. They
// act like files that exploit a library, without the exploit.
#pragma once

#include "storm_files/storm_format.h"

namespace thunderhead::sandbox {

// Returns the formats of this build, and the format of files that end in ".bad".
storm_files::StormFormats FormatsWithMisbehaving();

}  // namespace thunderhead::sandbox
