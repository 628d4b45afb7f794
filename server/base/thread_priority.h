// How much of the processors a thread gets beside others.
#pragma once

namespace thunderhead::base {

inline constexpr int kLowestPriority = 19;

// Sets the nice value of the calling thread and of those that it starts: 0, usual, to 19, idle
// time. Cannot be undone.
void LowerPriority(int niceness);

}  // namespace thunderhead::base
