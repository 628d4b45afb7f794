// Properties of the device that the thread's context draws with.
#pragma once

namespace thunderhead::gl {

// Returns true for Mesa's software renderer.
bool DrawsInSoftware();

}  // namespace thunderhead::gl
