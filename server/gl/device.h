// Properties of the device that the thread's context draws with.
#pragma once

namespace thunderhead::gl {

// Mesa's software renderer.
bool DrawsInSoftware();

}  // namespace thunderhead::gl
