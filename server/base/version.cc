#include "base/version.h"

namespace thunderhead::base {

std::string Version() { return THUNDERHEAD_VERSION; }

}  // namespace thunderhead::base
