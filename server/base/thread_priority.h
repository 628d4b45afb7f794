// Lowers the scheduling priority of threads.
#pragma once

namespace thunderhead::base {

inline constexpr int kLowestPriority = 19;

// Sets the nice value of the calling thread and of the threads that it starts, from 0 (normal) to
// 19 (idle time only). This cannot be undone.
void LowerPriority(int niceness);

}  // namespace thunderhead::base
