// The runners of the C++ library, one for each case file that names it.
#pragma once

#include "client-cpp/tests/cases/case_files.h"

namespace thunderhead::client::testing {

Actions RunBackOff(Arguments& given);
Actions RunCamera(Arguments& given);
Actions RunClamp(Arguments& given);
Actions RunControlResumption(Arguments& given);
Actions RunLimits(Arguments& given);
Actions RunParameters(Arguments& given);
Actions RunPlayback(Arguments& given);
Actions RunProjection(Arguments& given);
Actions RunSceneSync(Arguments& given);
Actions RunSessionState(Arguments& given);

}  // namespace thunderhead::client::testing
