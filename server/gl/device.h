// Properties of the device that the thread's context draws with.
#pragma once

namespace thunderhead::gl {

// Returns true if the context uses Mesa's software renderer.
bool DrawsInSoftware();

}  // namespace thunderhead::gl
