#include "base/thread_priority.h"

#include <sys/resource.h>
#include <unistd.h>

namespace thunderhead::base {

// On Linux a nice value belongs to a thread, although POSIX says that it belongs to a process.
void LowerPriority(int niceness) {
  ::setpriority(PRIO_PROCESS, static_cast<id_t>(::gettid()), niceness);
}

}  // namespace thunderhead::base
