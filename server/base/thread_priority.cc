#include "base/thread_priority.h"

#include <sys/resource.h>
#include <unistd.h>

namespace thunderhead::base {

// Linux has priorities of threads, against POSIX.
void LowerPriority(int niceness) {
  ::setpriority(PRIO_PROCESS, static_cast<id_t>(::gettid()), niceness);
}

}  // namespace thunderhead::base
